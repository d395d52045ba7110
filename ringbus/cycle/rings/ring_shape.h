#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/config/graph/ring.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// A ring whose stops have no queues, as numbers. Stops are counted by their places on the ring, and so are segments:
/// segment s leads from stop s to the next one, in direction 1 back from there. A lane is one ring of one direction.
struct RingShape {
  explicit RingShape(const config::StopRing& ring)
      : drawn(ring),
        stops(static_cast<std::uint32_t>(ring.nodes.size())),
        directions(static_cast<std::uint32_t>(ring.directions())),
        rings(static_cast<std::uint32_t>(ring.rings())),
        hop(static_cast<Cycle>(ring.latency_cycles)),
        width(static_cast<std::uint64_t>(ring.bytes_per_cycle)),
        port(static_cast<std::uint64_t>(ring.drawn->stops.port_bytes_per_cycle.value_or(ring.bytes_per_cycle))),
        grants(ring.drawn->stops.rule == RingStops::Rule::kGrants),
        grant_cycles(static_cast<Cycle>(ring.drawn->stops.grant_cycles)) {}

  std::uint32_t lanes() const { return directions * rings; }
  std::uint32_t lane(std::uint32_t direction, std::uint32_t ring) const { return direction * rings + ring; }
  std::uint32_t hops(std::uint32_t from, std::uint32_t to, std::uint32_t direction) const {
    return direction == 0 ? (to + stops - from) % stops : (from + stops - to) % stops;
  }
  /// The direction of the shorter way, which is half of the ring at most; of equal ones that of the random number.
  std::uint32_t direction(std::uint32_t from, std::uint32_t to, std::uint32_t random) const {
    if (directions == 1) return 0;
    const std::uint32_t ahead = hops(from, to, 0), back = hops(from, to, 1);
    return ahead == back ? random & 1u : back < ahead;
  }
  /// The segment that a packet takes as its `i`th from a stop.
  std::uint32_t segment(std::uint32_t from, std::uint32_t i, std::uint32_t direction) const {
    return direction == 0 ? (from + i) % stops : (from + stops - 1 - i % stops) % stops;
  }
  /// The number of that segment's link in the graph.
  std::size_t link(std::uint32_t segment, std::uint32_t lane) const {
    return drawn.link(segment, lane / rings, lane % rings);
  }

  std::uint64_t flits(std::uint64_t bytes) const { return ceil_div(bytes, width); }
  /// Cycles for which a flit occupies a port.
  Cycle port_cycles() const { return std::max<Cycle>(1, ceil_div(width, port)); }
  /// Cycles for which a granted packet occupies a place: a ring is as slow as a port that is narrower.
  Cycle beats(std::uint64_t bytes) const { return ceil_div(bytes, std::min(width, port)); }
  /// Cycles of the way of a packet that nothing is in the way of, from being ready at its stop until its last flit is
  /// through the port of its destination.
  Cycle alone(std::uint32_t hops, std::uint64_t bytes) const {
    if (grants) return grant_cycles + hops * hop + beats(bytes) - 1;
    return flits(bytes) * port_cycles() - 1 + hops * hop + port_cycles() - 1;
  }

  config::StopRing drawn;
  std::uint32_t stops, directions, rings;
  Cycle hop;                  // of a segment
  std::uint64_t width, port;  // bytes a cycle
  bool grants;
  Cycle grant_cycles;
};

/// A packet on a ring: of synthetic traffic, the answer to one, or one that `tag` names.
struct RingPacket {
  Cycle created = 0;               ///< by the clock of the resources; of an answer, that of what it answers
  std::uint32_t from = 0, to = 0;  ///< stops
  std::uint32_t direction = 0;
  std::uint32_t random = 0;
  std::uint32_t flit_hops = 0;  ///< links that its flits cross, with those of what it answers
  std::uint32_t bytes = 0;
  bool answer = false;
  Cycle ready = 0;  ///< at its stop, by the clock of the network
  std::uint32_t tag = 0;
};

}  // namespace carousel::ringbus::cycle
