#include "ringbus/topology/routes.h"

#include <set>
#include <utility>

namespace carousel::ringbus {

namespace {

using Links = std::vector<std::vector<std::uint32_t>>;

/// Fills in the row of `start`: the first link of the way to each node.
void find_ways(const config::Graph& graph, const Links& out, std::uint32_t start, std::uint32_t* row) {
  constexpr std::int64_t kFar = std::numeric_limits<std::int64_t>::max();
  std::vector<std::int64_t> distance(graph.nodes.size(), kFar);
  std::set<std::pair<std::int64_t, std::uint32_t>> open{{0, start}};
  distance[start] = 0;
  while (!open.empty()) {
    const auto [so_far, at] = *open.begin();
    open.erase(open.begin());
    for (const std::uint32_t i : out[at]) {
      const config::Graph::Link& link = graph.links[i];
      const std::int64_t there = so_far + link.latency_cycles;
      if (there >= distance[link.to]) continue;
      open.erase({distance[link.to], link.to});
      distance[link.to] = there;
      row[link.to] = at == start ? i : row[at];
      open.emplace(there, link.to);
    }
  }
}

}  // namespace

Routes::Routes(const config::Graph& graph)
    : nodes_(graph.nodes.size()), links_(nodes_ * nodes_, kNone), ends_(graph.links.size()) {
  Links out(nodes_);
  for (std::uint32_t i = 0; i < graph.links.size(); ++i) {
    out[graph.links[i].from].push_back(i);
    ends_[i] = graph.links[i].to;
  }
  for (std::uint32_t node = 0; node < nodes_; ++node) find_ways(graph, out, node, links_.data() + node * nodes_);
}

}  // namespace carousel::ringbus
