#include "ringbus/cycle/parcels/parcel_plan.h"

#include <algorithm>
#include <deque>
#include <optional>

#include <fmt/format.h>

#include "core/config/graph/ring.h"
#include "core/config/graph/way_time.h"
#include "core/system/error.h"
#include "ringbus/topology/graph/routes.h"
#include "ringbus/topology/graph_facts.h"
#include "ringbus/topology/wire_length.h"

namespace carousel::ringbus {

namespace {

using config::Graph;
using Nodes = std::vector<std::uint32_t>;

/// By node: the resource that is the fewest links away, in whatever direction, and of these the first.
Nodes nearest_resources(const Graph& graph) {
  std::vector<Nodes> next(graph.nodes.size());
  for (const Graph::Link& link : graph.links) {
    next[link.from].push_back(link.to);
    next[link.to].push_back(link.from);
  }
  Nodes nearest(graph.nodes.size(), ParcelPlan::kNone);
  std::deque<std::uint32_t> open;
  for (std::uint32_t r = 0; r < graph.resources; ++r) {
    nearest[r] = r;
    open.push_back(r);
  }
  for (; !open.empty(); open.pop_front())
    for (const std::uint32_t node : next[open.front()]) {
      if (nearest[node] != ParcelPlan::kNone) continue;
      nearest[node] = nearest[open.front()];
      open.push_back(node);
    }
  std::ranges::replace(nearest, ParcelPlan::kNone, 0u);
  return nearest;
}

/// The longest way from any to any, by latency.
std::string longest_way(const Graph& graph, const Routes& routes, const Nodes& starts, const Nodes& ends) {
  std::optional<std::int64_t> longest;
  std::string text;
  for (const std::uint32_t from : starts)
    for (const std::uint32_t to : ends) {
      config::WayTime way(graph);
      routes.for_each_link(from, to, [&](std::uint32_t link) { way.go(graph.links[link]); });
      if (longest && way.cycles() <= *longest) continue;
      longest = way.cycles();
      text = fmt::format("{} cycles at most, from {} to {}", *longest, graph.nodes[from].name, graph.nodes[to].name);
    }
  return text;
}

/// "pools of workers: s[0] shades the rays of r[0], r[1]; s[1] of r[2]"
std::string pool_facts(const ParcelPlan& plan) {
  if (plan.parts.pools.size() < 2) return "";
  constexpr std::size_t kShown = 8;
  std::string out;
  for (const std::uint32_t pool : plan.parts.pools) {
    out += fmt::format("{}{} {}", out.empty() ? "pools of workers: " : "; ", plan.graph.nodes[pool].name,
                       out.empty() ? "shades the rays of " : "of ");
    std::size_t served = 0;
    for (std::uint32_t r = 0; r < plan.graph.resources; ++r) {
      if (plan.parts.pool_node(r) != pool) continue;
      if (served++ < kShown) out += (served > 1 ? ", " : "") + plan.graph.nodes[r].name;
    }
    if (served > kShown) out += fmt::format(" and {} more", served - kShown);
  }
  return out + "\n";
}

}  // namespace

std::vector<Graph::Link> ParcelPlan::without_packets() const {
  std::vector<Graph::Link> out;
  for (const Link& link : links)
    if (link.wire == kNone) out.push_back(drawn(link));
  return out;
}

double ParcelPlan::length(const Graph::Link& link, double link_mm) const {
  if (graph.nodes[link.from].at.given && graph.nodes[link.to].at.given) return ringbus::link_mm(graph, link);
  return link_mm * place_distance(graph.resources, beside_[link.from], beside_[link.to]);
}

double ParcelPlan::lengths_without_packets(std::int64_t bytes_per_cycle, double link_mm) const {
  double sum = 0;
  for (const Graph::Link& link : without_packets())
    sum += length(link, link_mm) * static_cast<double>(link.bytes_per_cycle) / static_cast<double>(bytes_per_cycle);
  return sum;
}

ParcelPlan plan_parcels(const TopologyConfig& config, std::int64_t line_bytes) {
  ParcelPlan plan;
  if (config.shape != TopologyShape::kGraph) return plan;
  plan.graph = draw_whole(config);
  std::vector<config::GraphIssue> issues;
  plan.parts = config::find_parts(config, plan.graph, line_bytes, issues);
  if (!issues.empty()) throw SimulationError(fmt::format("{}: {}", issues.front().key, issues.front().message));
  plan.beside_ = nearest_resources(plan.graph);
  std::uint32_t wires = 0;
  for (std::uint32_t i = 0; i < plan.graph.links.size(); ++i) {
    const Graph::Link& link = plan.graph.links[i];
    // A single resource has no wires for packets, and a ring whose stops have no queues has some of its own.
    const bool packets =
        link.carries_any({Carried::kPackets}) && config.resources > 1 && !config::has_stops(config.links[link.entry]);
    if (link.carries_any({Carried::kShapes, Carried::kNewRays, Carried::kCompletedRays}))
      plan.links.push_back({i, packets ? wires : ParcelPlan::kNone});
    wires += packets;
  }
  return plan;
}

std::string parcel_facts(const ParcelPlan& plan) {
  if (!plan.any()) return "";
  const Graph& graph = plan.graph;
  const Nodes caches = graph.of_kind(GraphNodeKind::kCache);
  std::string out =
      fmt::format("parts: {} caches, {} memories, {} shading, {} links that carry no packets\n", caches.size(),
                  plan.parts.memories.nodes.size(), plan.parts.pools.size(), plan.without_packets().size());
  out += pool_facts(plan);
  if (caches.empty()) return out;
  const Graph shapes = graph.only(Carried::kShapes);
  const Routes routes(shapes);
  std::string longest;
  Nodes served;
  for (std::size_t group = 0; group < plan.parts.caches.size(); ++group) {
    served.clear();
    for (std::uint32_t r = 0; r < graph.resources; ++r)
      if (plan.parts.caches_of[r] == group) served.push_back(r);
    out += fmt::format("ways to {}: {}\n", graph.nodes[plan.parts.caches[group].nodes.front()].name,
                       longest_way(shapes, routes, served, plan.parts.caches[group].nodes));
  }
  if (!plan.parts.memories.nodes.empty())
    out += fmt::format("ways to memory: {}\n", longest_way(shapes, routes, caches, plan.parts.memories.nodes));
  return out;
}

}  // namespace carousel::ringbus
