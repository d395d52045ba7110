#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/config/graph/graph.h"
#include "core/config/load/network_rules.h"

namespace carousel::config {

namespace {

/// The keys of a node that its kind has. Returns whether the node can be simulated.
bool check_node(const GraphNode& node, const std::string& key, const RuleBreach& breach) {
  if (!is_built(node.kind)) {
    breach(key + ".kind", fmt::format("a node that is a {0} is not built yet: caches, memory and shading have wires of "
                                      "their own, which memory.* and shading.* describe; expected resource or router, "
                                      "found {0}",
                                      enum_name(node.kind)));
    return false;
  }
  if (node.kind == GraphNodeKind::kRouter) return true;
  constexpr std::string_view otherwise = "only a router has this key; a resource has places for its packets in test";
  if (node.buffers) breach(key + ".buffers", fmt::format("{}; expected auto, found {}", otherwise, *node.buffers));
  if (node.forward != Forward::kHead)
    breach(key + ".forward", fmt::format("{}; expected head, found {}", otherwise, enum_name(node.forward)));
  return true;
}

}  // namespace

void check_graph(const Config& config, const RuleBreach& breach) {
  const TopologyConfig& c = config.topology;
  if (c.shape != TopologyShape::kGraph) return;
  bool built = true;
  for (std::size_t i = 0; i < c.nodes.size(); ++i)
    built &= check_node(c.nodes[i], fmt::format("topology.nodes.{}", i), breach);
  const std::int64_t resources = drawn_resources(c);
  if (resources == 0) return breach("topology.nodes", "expected a resource at least, such as {name: r, count: 8}");
  if (resources <= kMaxResources && resources != c.resources)
    breach("topology.resources",
           fmt::format("the graph has {0} resources; expected {0}, or no number, found {1}", resources, c.resources));
  if (config.area.budget_mm2 && config.area.fit == AreaConfig::Fit::kResources)
    breach("area.fit",
           "a graph has as many resources as are drawn, which no budget changes; expected another fit, or no "
           "area.budget_mm2; found resources");
  std::vector<GraphIssue> issues;
  const Graph graph = draw_graph(c, issues);
  if (issues.empty() && built) check_ways(graph, issues);
  const auto narrow = std::ranges::find_if(
      graph.links, [&](const Graph::Link& link) { return link.bytes_per_cycle != c.link.bytes_per_cycle; });
  const bool parts =
      config.packets.results == PacketResults::kPerShape || config.packets.results == PacketResults::kMessage;
  if (parts && narrow != graph.links.end() && config.workload.kind != WorkloadConfig::Kind::kTraffic)
    breach("packets.results",
           fmt::format("each result begins a cycle of its own, which is counted for links as wide as topology.link; "
                       "{} is {} bytes wide; expected mask or implied_order, found {}",
                       graph.name_of(*narrow), narrow->bytes_per_cycle, enum_name(config.packets.results)));
  const auto shallow = std::ranges::find_if(graph.links, [](const Graph::Link& link) { return link.depth < 2; });
  if (c.flow == Flow::kBubble && shallow != graph.links.end() && c.link.depth >= 2)
    breach(fmt::format("topology.links.{}.depth", shallow->entry),
           fmt::format("flow: bubble keeps one place of a link free; expected at least 2 for {}, found {}",
                       graph.name_of(*shallow), shallow->depth));
  for (GraphIssue& issue : issues) breach(issue.key, std::move(issue.message));
}

}  // namespace carousel::config
