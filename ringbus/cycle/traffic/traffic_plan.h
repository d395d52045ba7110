#pragma once

#include <cstdint>
#include <vector>

#include "core/config/config.h"
#include "ringbus/cycle/traffic/traffic_node.h"

namespace carousel::ringbus::cycle {

/// Who creates how many of the packets. All sources stop at once, after the last of workload.traffic.packets, so the
/// load is the same until then. Sources do not depend on the network, so this is known beforehand.
struct TrafficPlan {
  explicit TrafficPlan(const Config& config);

  GeometricGap gap;
  std::vector<std::uint64_t> packets;  ///< by resource
  TrafficWindow window;
};

}  // namespace carousel::ringbus::cycle
