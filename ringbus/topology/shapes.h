#pragma once

#include "core/config/fields/topology.h"
#include "ringbus/topology/plan.h"

namespace carousel::ringbus {

/// The plan of the shape that the configuration names. A machine of one resource has no wires, whatever its shape.
/// Throws a SimulationError for a shape that has no plan.
TopologyPlan plan_topology(const TopologyConfig& config);
/// The same for synthetic traffic, whose packets keep their lanes on a drawing without virtual channels.
TopologyPlan plan_traffic(const TopologyConfig& config);

// One function a shape, each in the file of its name. A hierarchical network, a bus and a central machine are planned
// as the graphs that drawn_shape.h draws of them.
TopologyPlan plan_ring(const TopologyConfig& config);
TopologyPlan plan_bidirectional(const TopologyConfig& config);
TopologyPlan plan_multi_ring(const TopologyConfig& config);
TopologyPlan plan_point_to_point(const TopologyConfig& config);
TopologyPlan plan_independent(const TopologyConfig& config);
TopologyPlan plan_graph(const TopologyConfig& config);
TopologyPlan plan_lanes(const TopologyConfig& config);

}  // namespace carousel::ringbus
