#include "ringbus/topology/graph_facts.h"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

#include "core/system/error.h"
#include "ringbus/topology/dependencies.h"
#include "ringbus/topology/routes.h"

namespace carousel::ringbus {

using config::Graph;

Graph draw_whole(const TopologyConfig& config) {
  std::vector<config::GraphIssue> issues;
  Graph graph = config::draw_graph(config, issues);
  if (issues.empty()) config::check_ways(graph, issues);
  if (!issues.empty()) throw SimulationError(fmt::format("{}: {}", issues.front().key, issues.front().message));
  return graph;
}

Graph draw_checked(const TopologyConfig& config) {
  return draw_whole(config).only(Carried::kPackets);
}

std::string circle_text(const Graph& graph, const std::vector<std::uint32_t>& circle) {
  constexpr std::size_t kShown = 8;
  std::string out;
  for (std::size_t i = 0; i < circle.size() && i < kShown; ++i)
    out += (i == 0 ? "" : ", ") + graph.name_of(graph.links[circle[i]]);
  return circle.size() > kShown ? fmt::format("{} and {} more", out, circle.size() - kShown) : out;
}

GraphFacts graph_facts(const TopologyConfig& config) {
  const Graph graph = draw_checked(config);
  const Routes routes(graph);
  GraphFacts facts;
  facts.resources = graph.resources;
  facts.routers = graph.of_kind(GraphNodeKind::kRouter).size();
  facts.links = graph.links.size();
  std::vector<std::uint64_t> pairs(graph.links.size());
  std::uint64_t nodes = 0;
  std::int64_t cycles = 0;
  for (std::uint32_t from = 0; from < graph.resources; ++from)
    for (std::uint32_t to = 0; to < graph.resources; ++to) {
      std::int64_t way = 0;
      ++nodes;
      routes.for_each_link(from, to, [&](std::uint32_t link) {
        way += graph.nodes[graph.links[link].from].drawn->latency_cycles + graph.links[link].latency_cycles;
        ++pairs[link];
        ++nodes;
      });
      cycles += way;
      if (way <= facts.longest_cycles) continue;
      facts.longest_cycles = way;
      facts.longest_from = graph.nodes[from].name;
      facts.longest_to = graph.nodes[to].name;
    }
  const double all = static_cast<double>(graph.resources) * static_cast<double>(graph.resources);
  facts.mean_nodes = static_cast<double>(nodes) / all;
  facts.mean_cycles = static_cast<double>(cycles) / all;
  if (graph.links.empty()) return facts;
  std::uint32_t busiest = 0;
  const auto load = [&](std::uint32_t link) {
    return static_cast<double>(pairs[link]) / static_cast<double>(graph.links[link].bytes_per_cycle);
  };
  const auto ends = [&](std::uint32_t link) { return std::tuple(graph.links[link].from, graph.links[link].to); };
  for (std::uint32_t link = 1; link < graph.links.size(); ++link)
    if (load(link) > load(busiest) || (load(link) == load(busiest) && ends(link) < ends(busiest))) busiest = link;
  facts.busiest = graph.name_of(graph.links[busiest]);
  facts.busiest_pairs = pairs[busiest];
  if (facts.busiest_pairs > 0)
    facts.bound =
        static_cast<double>(graph.resources) / (load(busiest) * static_cast<double>(config.link.bytes_per_cycle));
  return facts;
}

DeadlockVerdict traffic_verdict(const TopologyConfig& config) {
  const Graph graph = draw_checked(config);
  const Routes routes(graph);
  const std::vector<std::uint64_t> places(graph.links.size(), 1);
  const std::vector<std::uint32_t> circle = traffic_dependencies(graph, routes).smallest_circle(places, 2);
  if (circle.empty())
    return {false,
            "no circle: the links of all ways can be put in an order in which every packet takes them, and the "
            "sink takes every packet in"};
  return {true, fmt::format("a circle of {} links wait for one another when they are full ({}); on a graph no rule "
                            "keeps synthetic traffic from that",
                            circle.size(), circle_text(graph, circle))};
}

}  // namespace carousel::ringbus
