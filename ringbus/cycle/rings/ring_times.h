#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/config/graph/ring.h"
#include "ringbus/cycle/rings/ring_shape.h"
#include "ringbus/topology/graph_facts.h"

namespace carousel::ringbus::cycle {

/// The shapes of all rings without queues of a network, in order. Keeps a reference to the configuration.
class RingTimes {
 public:
  explicit RingTimes(const TopologyConfig& config) {
    if (!config::stop_ring_entry(config)) return;
    const config::Graph graph = draw_checked(config);
    for (const config::StopRing& ring : config::stop_rings(config, graph)) shapes_.emplace_back(ring);
  }

  /// Cycles of the ring from when a packet is ready at the stop `from` until its last flit is through the port of the
  /// stop `to`, if no other is in its way. `number`: of the ring.
  Cycle alone(std::size_t number, const TopologyPlan::StopRing& ring, ResourceId from, ResourceId to,
              std::uint64_t bytes) const {
    const RingShape& shape = shapes_[number];
    const std::uint32_t first = ring.places[from.value], last = ring.places[to.value];
    return shape.alone(shape.hops(first, last, shape.direction(first, last, 0)), bytes);
  }

 private:
  std::vector<RingShape> shapes_;
};

}  // namespace carousel::ringbus::cycle
