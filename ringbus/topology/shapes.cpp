#include "ringbus/topology/shapes.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "core/config/fields/topology.h"
#include "core/config/graph/lane_rings.h"
#include "core/system/error.h"
#include "core/types/enum_names.h"
#include "ringbus/topology/drawn_shape.h"

namespace carousel::ringbus {

namespace {

struct Shape {
  TopologyShape shape;
  TopologyPlan (*plan)(const TopologyConfig& config);
};

TopologyPlan plan_drawn(const TopologyConfig& config) {
  return plan_graph(draw_shape(config).config);
}

constexpr std::array kShapes{
    Shape{TopologyShape::kRing, plan_ring},
    Shape{TopologyShape::kBidirectional, plan_bidirectional},
    Shape{TopologyShape::kMultiRing, plan_multi_ring},
    Shape{TopologyShape::kHierarchical, plan_drawn},
    Shape{TopologyShape::kPointToPoint, plan_point_to_point},
    Shape{TopologyShape::kBus, plan_drawn},
    Shape{TopologyShape::kCentral, plan_drawn},
    Shape{TopologyShape::kIndependent, plan_independent},
    Shape{TopologyShape::kGraph, plan_graph},
};

/// Fills in what is so of every plan.
TopologyPlan completed(TopologyPlan plan, const TopologyConfig& config) {
  if (config.resources == 1) {
    plan.wires.clear();
    plan.hubs.clear();
    plan.rings.clear();
    plan.routed = false;
    plan.exits.clear();
    plan.verdict = {false, "one resource: packets are tested where they are issued, there are no links"};
  }
  for (TopologyPlan::Wire& wire : plan.wires) {
    if (wire.depth == 0) wire.depth = config.link.depth;
    if (wire.bytes_per_cycle == 0) wire.bytes_per_cycle = config.link.bytes_per_cycle;
  }
  return plan;
}

}  // namespace

TopologyPlan plan_topology(const TopologyConfig& config) {
  const auto found =
      std::find_if(kShapes.begin(), kShapes.end(), [&](const Shape& shape) { return shape.shape == config.shape; });
  if (found == kShapes.end())
    throw SimulationError(fmt::format("topology.shape: there is no plan of {}", enum_name(config.shape)));
  return completed(found->plan(config), config);
}

TopologyPlan plan_traffic(const TopologyConfig& config) {
  return config::keeps_lanes(config) ? completed(plan_lanes(config), config) : plan_topology(config);
}

}  // namespace carousel::ringbus
