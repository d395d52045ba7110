#pragma once

#include <cstdint>

#include "core/config/config.h"
#include "core/types/ids.h"

namespace carousel::ringbus::cycle {

/// How a packet of synthetic traffic gets to its destination.
struct TrafficRoute {
  std::uint16_t direction = 0;  ///< of the ring it takes
  std::uint16_t hops = 0;       ///< links to cross; 0: it is there already
};

/// The shortest way. What is as far both ways round a bidirectional ring, or has several rings to choose from, is
/// spread by `random` (as BookSim2's dim_order routing on a torus).
inline TrafficRoute traffic_route(const TopologyConfig& topology, ResourceId from, ResourceId to,
                                  std::uint32_t random) {
  const std::uint32_t resources = static_cast<std::uint32_t>(topology.resources);
  const std::uint32_t ahead = to.value >= from.value ? to.value - from.value : to.value + resources - from.value;
  const auto route = [](std::uint32_t direction, std::uint32_t hops) {
    return TrafficRoute{static_cast<std::uint16_t>(direction), static_cast<std::uint16_t>(hops)};
  };
  switch (topology.shape) {
    case TopologyShape::kPointToPoint:
      return route(0, ahead == 0 ? 0 : 1);
    case TopologyShape::kMultiRing:
      return route(random % static_cast<std::uint32_t>(topology.rings), ahead);
    case TopologyShape::kBidirectional: {
      const std::uint32_t back = resources - ahead;
      const bool backwards = ahead > back || (ahead == back && (random & 1) != 0);
      return backwards ? route(1, back) : route(0, ahead);
    }
    default:
      return route(0, ahead);
  }
}

}  // namespace carousel::ringbus::cycle
