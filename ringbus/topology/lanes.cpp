#include <utility>

#include "core/config/graph/lane_rings.h"
#include "core/system/error.h"
#include "ringbus/topology/graph_facts.h"
#include "ringbus/topology/rounds.h"
#include "ringbus/topology/shapes.h"

namespace carousel::ringbus {

namespace {

bool goes_back(const std::vector<ResourceId>& there, const std::vector<ResourceId>& back) {
  for (std::uint32_t r = 0; r < there.size(); ++r)
    if (back[there[r].value].value != r) return false;
  return true;
}

}  // namespace

/// Rings that are drawn, lane by lane: those of the shapes ring, bidirectional and multi_ring, or point_to_point.
/// Acknowledgements of a lane's packets travel back by a lane that goes the other way round, if there is one.
TopologyPlan plan_lanes(const TopologyConfig& config) {
  std::vector<config::GraphIssue> issues;
  const config::LaneRings lanes = config::lane_rings(config, draw_checked(config), issues);
  if (!issues.empty()) throw SimulationError(issues.front().key + ": " + issues.front().message);
  if (lanes.direct) return plan_point_to_point(config);
  std::vector<std::vector<ResourceId>> rounds;
  for (const std::vector<std::uint32_t>& next : lanes.next) {
    std::vector<ResourceId>& round = rounds.emplace_back();
    for (const std::uint32_t to : next) round.push_back(ResourceId(to));
  }
  TopologyPlan plan = plan_of_rounds(config, std::move(rounds));
  for (std::uint16_t lane = 0; lane < plan.successors.size(); ++lane)
    for (std::uint16_t other = 0; other < plan.successors.size(); ++other)
      if (other != lane && goes_back(plan.successors[lane], plan.successors[other])) {
        plan.ack_directions[lane] = other;
        break;
      }
  return plan;
}

}  // namespace carousel::ringbus
