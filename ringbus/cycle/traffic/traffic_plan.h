#pragma once

#include <cstdint>
#include <vector>

#include "core/config/fields/workload.h"
#include "ringbus/cycle/traffic/traffic_source.h"

namespace carousel::ringbus::cycle {

/// The measured window. Packets created from `begin` on are measured; sources stop before `end`.
struct TrafficWindow {
  Cycle begin = 0, end = 0;
};

/// The number of packets that each source creates. All sources stop at once, after the last of
/// workload.traffic.packets, so the load is the same until then. Sources do not depend on the network, so this is known
/// beforehand.
struct TrafficPlan {
  TrafficPlan(const TrafficConfig& traffic, std::uint64_t seed, std::size_t resources, const TrafficEnds& ends);

  GeometricGap gap;
  std::vector<std::uint64_t> packets;  ///< by resource
  TrafficWindow window;
};

}  // namespace carousel::ringbus::cycle
