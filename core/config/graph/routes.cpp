#include "core/config/graph/routes.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "core/types/added_names.h"
#include "core/types/router_rule.h"

namespace carousel::config {

namespace {

using Links = std::vector<std::vector<std::uint32_t>>;  // by node

constexpr std::int64_t kFar = std::numeric_limits<std::int64_t>::max();

/// Fills in the row of `start`: the first link of the shortest way to each node.
void find_ways(const Graph& graph, const Links& out, std::uint32_t start, std::uint32_t* row) {
  std::vector<std::int64_t> distance(graph.nodes.size(), kFar);
  std::set<std::pair<std::int64_t, std::uint32_t>> open{{0, start}};
  distance[start] = 0;
  while (!open.empty()) {
    const auto [so_far, at] = *open.begin();
    open.erase(open.begin());
    for (const std::uint32_t i : out[at]) {
      const Graph::Link& link = graph.links[i];
      const std::int64_t there = so_far + link.latency_cycles;
      if (there >= distance[link.to]) continue;
      open.erase({distance[link.to], link.to});
      distance[link.to] = there;
      row[link.to] = at == start ? i : row[at];
      open.emplace(there, link.to);
    }
  }
}

/// Links from `start` to each node, in either direction; kNone where none leads.
std::vector<std::uint32_t> levels_from(const Graph& graph, std::uint32_t start) {
  Links beside(graph.nodes.size());
  for (const Graph::Link& link : graph.links) {
    beside[link.from].push_back(link.to);
    beside[link.to].push_back(link.from);
  }
  std::vector<std::uint32_t> level(graph.nodes.size(), Routes::kNone), open{start};
  level[start] = 0;
  for (std::size_t i = 0; i < open.size(); ++i)
    for (const std::uint32_t next : beside[open[i]])
      if (level[next] == Routes::kNone) {
        level[next] = level[open[i]] + 1;
        open.push_back(next);
      }
  return level;
}

/// Fills in the table of up_down, whose columns are destinations.
class UpDown {
 public:
  UpDown(const Graph& graph, const Links& out)
      : graph_(graph), out_(out), level_(levels_from(graph, root_of(graph))), downwards_(graph.nodes.size()) {
    std::iota(downwards_.begin(), downwards_.end(), 0u);
    std::ranges::sort(downwards_, {}, [&](std::uint32_t node) { return height(node); });
  }

  void find_ways_to(std::uint32_t to, std::uint32_t* links) const {
    const std::size_t nodes = graph_.nodes.size();
    std::vector<std::int64_t> distance(nodes, kFar);
    distance[to] = 0;
    const auto look = [&](std::uint32_t at, bool down) {
      std::tuple best{kFar, Routes::kNone, Routes::kNone};  // cycles, next node, link
      for (const std::uint32_t i : out_[at]) {
        const Graph::Link& link = graph_.links[i];
        if ((height(link.to) > height(at)) != down || distance[link.to] == kFar) continue;
        best = std::min(best, std::tuple{link.latency_cycles + distance[link.to], link.to, i});
      }
      if (std::get<0>(best) == kFar) return;
      distance[at] = std::get<0>(best);
      links[at * nodes + to] = std::get<2>(best);
    };
    // A way down leads to nodes that are lower, which have theirs already.
    for (std::size_t i = nodes; i-- > 0;)
      if (downwards_[i] != to) look(downwards_[i], true);
    for (const std::uint32_t at : downwards_)
      if (distance[at] == kFar) look(at, false);
  }

 private:
  std::pair<std::uint32_t, std::uint32_t> height(std::uint32_t node) const { return {level_[node], node}; }

  const Graph& graph_;
  const Links& out_;
  std::vector<std::uint32_t> level_;      // by node: links from the root
  std::vector<std::uint32_t> downwards_;  // nodes, the root first
};

/// Puts the answers of a plugin's router in place of the shortest ways, which `links` has.
void ask_router(const RouterRule& rule, const Graph& graph, const Links& out, std::size_t lane,
                std::vector<std::uint32_t>& links) {
  const std::size_t nodes = graph.nodes.size();
  std::vector<RouterNode> facts;
  for (std::uint32_t i = 0; i < nodes; ++i) {
    const GraphPoint& at = graph.nodes[i].at;
    facts.push_back({i < graph.resources, at.given, at.x, at.y});
  }
  std::vector<RouterLink> choices;
  for (std::uint32_t at = 0; at < nodes; ++at) {
    choices.clear();
    for (const std::uint32_t i : out[at])
      choices.push_back({graph.links[i].to, graph.links[i].latency_cycles, graph.links[i].bytes_per_cycle});
    for (std::uint32_t to = 0; to < graph.resources; ++to) {
      if (to == at || choices.empty()) continue;
      std::uint32_t& link = links[at * nodes + to];
      const auto shortest = static_cast<std::size_t>(std::ranges::find(out[at], link) - out[at].begin());
      const std::size_t chosen = rule.choose({facts, choices, at, to, static_cast<std::uint32_t>(lane), shortest});
      link = chosen < choices.size() ? out[at][chosen] : Routes::kNone;
    }
  }
}

}  // namespace

std::uint32_t root_of(const Graph& graph) {
  if (graph.root) return *graph.root;
  std::uint32_t best = 0, least = Routes::kNone;
  for (std::uint32_t node = 0; node < graph.nodes.size(); ++node) {
    const std::vector<std::uint32_t> levels = levels_from(graph, node);
    if (levels.front() == Routes::kNone) continue;  // no packets come here
    std::uint32_t farthest = 0;
    for (const std::uint32_t level : levels)
      if (level != Routes::kNone) farthest = std::max(farthest, level);
    if (farthest < least) {
      best = node;
      least = farthest;
    }
  }
  return best;
}

namespace {

/// Tells whether from some node packets come to another by more than one of its links, and not back through it.
bool has_choices(const Graph& graph, std::size_t lane) {
  const std::size_t nodes = graph.nodes.size();
  Links out(nodes);  // the ends of the links
  for (const Graph::Link& link : graph.links)
    if (link.is_for(lane)) out[link.from].push_back(link.to);
  for (std::uint32_t start = 0; start < nodes; ++start) {
    std::vector<std::uint32_t> by(nodes, Routes::kNone);  // the node behind `start` through which each is reached
    for (const std::uint32_t first : out[start]) {
      if (by[first] != Routes::kNone) return true;
      by[first] = first;
      std::vector<std::uint32_t> open{first};
      for (std::size_t i = 0; i < open.size(); ++i)
        for (const std::uint32_t next : out[open[i]]) {
          if (next == start || by[next] == first) continue;
          if (by[next] != Routes::kNone) return true;
          by[next] = first;
          open.push_back(next);
        }
    }
  }
  return false;
}

}  // namespace

bool latencies_choose_ways(const TopologyConfig& config) {
  std::vector<GraphIssue> ignored;
  const Graph graph = draw_graph(config, ignored).only(Carried::kPackets);
  if (is_added(graph.routing)) return true;      // a plugin is told them
  std::set<std::optional<std::size_t>> said_by;  // entries; topology.link
  for (const Graph::Link& link : graph.links)
    said_by.insert(config.links[link.entry].latency_cycles ? std::optional(link.entry) : std::nullopt);
  const bool nearest = config.tour == Tour::kNearest && graph.resources > 2,
             nodes = std::ranges::any_of(config.nodes, [](const auto&one) { return one.latency_cycles > 0; });
  if (nearest && (nodes || said_by.size() > 1)) return true;
  if (said_by.size() < 2) return false;
  for (std::size_t lane = 0; lane < graph.lanes; ++lane)
    if (has_choices(graph, lane)) return true;
  return false;
}

Routes::Routes(const Graph& graph, std::size_t lane)
    : nodes_(graph.nodes.size()), links_(nodes_ * nodes_, kNone), ends_(graph.links.size()) {
  Links out(nodes_);
  for (std::uint32_t i = 0; i < graph.links.size(); ++i) {
    if (graph.links[i].is_for(lane)) out[graph.links[i].from].push_back(i);
    ends_[i] = graph.links[i].to;
  }
  if (graph.routing == Routing::kUpDown) {
    const UpDown rule(graph, out);
    for (std::uint32_t node = 0; node < nodes_; ++node) rule.find_ways_to(node, links_.data());
    return;
  }
  for (std::uint32_t node = 0; node < nodes_; ++node) find_ways(graph, out, node, links_.data() + node * nodes_);
  if (const auto* rule = added_body<RouterRule>(graph.routing)) ask_router(*rule, graph, out, lane, links_);
  for (const Graph::Hop& hop : graph.hops)
    if (graph.links[hop.link].is_for(lane)) links_[hop.at * nodes_ + hop.to] = hop.link;
}

}  // namespace carousel::config
