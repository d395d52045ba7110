#include "core/config/graph/lane_rings.h"

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/config/graph/ring.h"

namespace carousel::config {

namespace {

constexpr std::string_view kWithout = "without virtual channels";

/// Names a property of the node that a station of a ring cannot have.
std::optional<GraphIssue> fault_of(const Graph::Node& node) {
  const std::string key = fmt::format("topology.nodes.{}", node.entry);
  const GraphNode& drawn = *node.drawn;
  if (drawn.kind != GraphNodeKind::kResource)
    return GraphIssue{key + ".kind",
                      fmt::format("{} packets go round rings of resources; expected resource, or another "
                                  "topology.channels; found {}",
                                  kWithout, enum_name(drawn.kind))};
  for (const auto& [name, cycles] :
       {std::pair("latency_cycles", drawn.latency_cycles), std::pair("credit_cycles", drawn.credit_cycles)})
    if (cycles != 0)
      return GraphIssue{fmt::format("{}.{}", key, name),
                        fmt::format("{} a packet passes a node in the cycle in which it comes; expected 0, found {}",
                                    kWithout, cycles)};
  return std::nullopt;
}

/// Names a property of the link that other links do not share.
std::optional<GraphIssue> fault_of(const LinkConfig& all, const Graph::Link& link) {
  for (const auto& [name, found, expected] : {std::tuple("latency_cycles", link.latency_cycles, all.latency_cycles),
                                              {"bytes_per_cycle", link.bytes_per_cycle, all.bytes_per_cycle},
                                              {"depth", link.depth, all.depth},
                                              {"virtual_channels", link.virtual_channels, std::int64_t{1}}})
    if (found != expected)
      return GraphIssue{
          fmt::format("topology.links.{}.{}", link.entry, name),
          fmt::format("{} all links are as topology.link says; expected {}, found {}", kWithout, expected, found)};
  return std::nullopt;
}

/// The ring of a lane; nothing if its links are none.
std::optional<std::vector<std::uint32_t>> ring_of(const Graph& graph, std::size_t lane) {
  std::vector<std::uint32_t> next(graph.resources, graph.resources);
  for (const Graph::Link& link : graph.links) {
    if (!link.is_for(lane)) continue;
    if (next[link.from] != graph.resources) return std::nullopt;
    next[link.from] = link.to;
  }
  std::uint32_t at = 0, steps = 0;
  do {
    at = next[at];
    ++steps;
  } while (at != graph.resources && at != 0 && steps < graph.resources);
  if (at != 0 || steps != graph.resources) return std::nullopt;
  return next;
}

}  // namespace

bool keeps_lanes(const TopologyConfig& config) {
  return config.shape == TopologyShape::kGraph && config.channels == ChannelRule::kNone && !stop_ring_entry(config);
}

LaneRings lane_rings(const TopologyConfig& config, const Graph& graph, std::vector<GraphIssue>& issues) {
  LaneRings out;
  const auto issue = [&](std::optional<GraphIssue> found) {
    if (found) issues.push_back(*std::move(found));
    return found.has_value();
  };
  for (const Graph::Node& node : graph.nodes)
    if (issue(fault_of(node))) return out;
  for (const Graph::Link& link : graph.links)
    if (issue(fault_of(config.link, link))) return out;
  const auto has_clock = [](const auto& one) { return one.mhz != 0; };
  if (std::ranges::any_of(graph.links, has_clock) ||
      std::ranges::any_of(graph.nodes, has_clock,
                          [](const Graph::Node& node) -> const GraphNode& { return *node.drawn; })) {
    issues.push_back({"topology.channels", fmt::format("{} packets go by the clock of the resources; expected no other "
                                                       "clock of nodes and links, or any, dateline or hops; found none",
                                                       kWithout)});
    return out;
  }
  if (graph.resources == 1) {
    out.next.assign(graph.lanes, {0});
    return out;
  }
  for (std::size_t lane = 0; lane < graph.lanes && !graph.lanes_meet(); ++lane)
    if (auto ring = ring_of(graph, lane)) out.next.push_back(*std::move(ring));
  if (out.next.size() == graph.lanes) return out;
  // No link is there twice.
  out.direct = graph.lanes == 1 && graph.links.size() == std::size_t{graph.resources} * (graph.resources - 1);
  if (!out.direct)
    issues.push_back({"topology.channels",
                      fmt::format("{} a packet keeps its lane, so the links of each lane are one ring through all "
                                  "resources, or a link leads from each resource to every other; expected such links, "
                                  "or any, dateline or hops; found none",
                                  kWithout)});
  return out;
}

}  // namespace carousel::config
