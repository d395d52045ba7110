#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/config/graph/graph.h"

namespace carousel::config {

/// A drawn ring whose stops have no queues (`stops.rule: slots` or `grants`).
struct StopRing {
  const GraphLink* drawn = nullptr;  ///< of the configuration, which must outlive it
  std::size_t entry = 0;             ///< its place in topology.links
  std::size_t first = 0;             ///< of its links in the graph, which follow one another
  std::vector<std::uint32_t> nodes;  ///< in the order of the ring; those of the graph
  std::int64_t latency_cycles = 1, bytes_per_cycle = 1;

  std::size_t directions() const { return drawn->both ? 2 : 1; }
  std::size_t rings() const { return static_cast<std::size_t>(drawn->stops.rings); }
  std::size_t links() const { return nodes.size() * directions() * rings(); }
  bool owns(std::size_t link) const { return link >= first && link - first < links(); }
  /// The width of a stop's port to the rings, and of that from them.
  std::int64_t port_bytes_per_cycle() const { return drawn->stops.port_bytes_per_cycle.value_or(bytes_per_cycle); }
  /// The link of the graph by which a ring leads from the place `segment` on the ring to the next, or back from there
  /// in direction 1: the order in which draw_graph() writes the links of such a ring.
  std::size_t link(std::size_t segment, std::size_t direction, std::size_t ring) const {
    return first + (segment * directions() + direction) * rings() + ring;
  }
};

/// Tells whether the entry draws a ring whose stops have no queues.
inline bool has_stops(const GraphLink& link) {
  return link.stops.rule != RingStops::Rule::kQueues;
}

/// The place in topology.links of the first ring whose stops have no queues; absent without one, and on other shapes.
std::optional<std::size_t> stop_ring_entry(const TopologyConfig& config);

/// The same if that ring is the whole network of packets: no other link carries any.
std::optional<std::size_t> lone_stop_ring_entry(const TopologyConfig& config);

/// All such rings, in the order of topology.links. `graph`: of a checked configuration; links that carry no packets may
/// be left out.
std::vector<StopRing> stop_rings(const TopologyConfig& config, const Graph& graph);

/// By node of the graph: the entry of the ring if that is all there is at the node for packets, so that nothing waits
/// there; absent elsewhere.
std::vector<std::optional<std::size_t>> plain_stops(const TopologyConfig& config, const Graph& graph);

/// The resources that a pattern of names stands for, in its order; all of them if it is empty. Of none, `error` says
/// why there are none.
std::vector<std::uint32_t> named_resources(const TopologyConfig& config, const std::string& pattern,
                                           std::string& error);

}  // namespace carousel::config
