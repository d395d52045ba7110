#pragma once

#include "core/config/fields/topology.h"
#include "core/config/graph/graph.h"
#include "ringbus/topology/graph/channel_plan.h"
#include "ringbus/topology/graph/dependencies.h"
#include "ringbus/topology/graph/routes.h"

namespace carousel::ringbus {

/// The virtual channels of a graph by topology.channels. Datelines are the links that say so; if none does, links are
/// taken one by one until none of the circles in which links wait for one another is left without one (a greedy choice:
/// each time the link that most others wait for and that waits for most).
ChannelPlan plan_channels(const TopologyConfig& config, const config::Graph& graph, const Routes& routes);

/// Which channels wait for which under synthetic traffic, and what their numbers mean. A link has a number for each
/// class of its channels.
struct ChannelDependencies {
  Dependencies waits{0};
  std::vector<std::uint32_t> link_of, class_of;  ///< by number
};
ChannelDependencies channel_dependencies(const config::Graph& graph, const Routes& routes, const ChannelPlan& plan);

}  // namespace carousel::ringbus
