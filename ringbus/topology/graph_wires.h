#pragma once

#include <vector>

#include "core/config/graph/graph.h"
#include "core/config/graph/ring.h"
#include "ringbus/topology/graph/routes.h"
#include "ringbus/topology/plan.h"

namespace carousel::ringbus {

/// The direction of a link's packets: its lane, and 0 of one for all.
std::uint16_t direction_of(const config::Graph::Link& link);

/// Fills in hubs, wires, exits and the ways over rings of a plan whose nodes are those of the graph. A link is a wire,
/// unless a ring owns it whose stops have no queues. Each such ring is a hub behind all other nodes, with a wire of a
/// cycle from each of its stops and one back; these stand behind the links. `routes`: by lane.
void plan_wires(const TopologyConfig& config, const config::Graph& graph, const std::vector<config::StopRing>& rings,
                const std::vector<Routes>& routes, TopologyPlan& plan);

}  // namespace carousel::ringbus
