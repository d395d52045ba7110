#pragma once

#include <cstdint>
#include <vector>

#include "core/config/graph/graph.h"

namespace carousel::config {

/// The links of a drawing without virtual channels (`topology.channels: none`), on which a synthetic packet keeps its
/// lane: each lane is a ring through all resources, or links lead from each resource straight to every other.
struct LaneRings {
  bool direct = false;                           ///< links lead from each resource to every other
  std::vector<std::vector<std::uint32_t>> next;  ///< else by lane, then resource: the next one on the lane's ring
};

/// Tells whether synthetic packets keep their lanes on this network.
bool keeps_lanes(const TopologyConfig& config);

/// Finds the rings of a drawing of which keeps_lanes() holds; `graph`: its links for packets. Appends the first
/// reason why they are no such rings to `issues`; the result is then incomplete.
LaneRings lane_rings(const TopologyConfig& config, const Graph& graph, std::vector<GraphIssue>& issues);

}  // namespace carousel::config
