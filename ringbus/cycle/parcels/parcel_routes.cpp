#include "ringbus/cycle/parcels/parcel_routes.h"

#include "core/config/graph/way_time.h"
#include "ringbus/topology/graph/routes.h"

namespace carousel::ringbus::cycle {

using config::Graph;

ParcelRoutes::ParcelRoutes(const ParcelPlan& plan)
    : plan_(plan),
      nodes_(plan.graph.nodes.size()),
      exits_(kEnumNames<Carried>.size() * nodes_ * nodes_),
      out_(nodes_),
      in_(nodes_) {
  std::vector<std::uint32_t> ports(plan.graph.links.size());  // by link of the graph
  for (std::uint32_t i = 0; i < plan.links.size(); ++i) {
    const Graph::Link& link = plan.drawn(plan.links[i]);
    ports[plan.links[i].link] = static_cast<std::uint32_t>(out_[link.from].size());
    out_[link.from].push_back(i);
    in_[link.to].push_back(i);
  }
  for (const Carried what : {Carried::kShapes, Carried::kNewRays, Carried::kCompletedRays})
    find_exits(plan, what, ports);
}

Cycle ParcelRoutes::cycles(Carried what, std::uint32_t from, std::uint32_t to) const {
  config::WayTime way(plan_.graph);
  for (std::uint32_t at = from; at != to;) {
    const Graph::Link& link = plan_.drawn(plan_.links[out_[at][exit(what, at, to).port]]);
    way.go(link);
    at = link.to;
  }
  return static_cast<Cycle>(way.cycles());
}

void ParcelRoutes::find_exits(const ParcelPlan& plan, Carried what, const std::vector<std::uint32_t>& ports) {
  const Graph graph = plan.graph.only(what);
  if (graph.links.empty()) return;
  std::vector<std::uint32_t> ports_of;  // by link of `graph`
  for (std::uint32_t i = 0; i < plan.graph.links.size(); ++i)
    if (plan.graph.links[i].carries_any({what})) ports_of.push_back(ports[i]);
  const Routes routes(graph);
  for (std::uint32_t at = 0; at < nodes_; ++at)
    for (std::uint32_t to = 0; to < nodes_; ++to) {
      const std::uint32_t i = routes.link(at, to);
      if (i == Routes::kNone) continue;
      exits_[(static_cast<std::size_t>(what) * nodes_ + at) * nodes_ + to] = {ports_of[i],
                                                                              goes_through(graph, routes, i, to)};
    }
}

}  // namespace carousel::ringbus::cycle
