#include "core/config/graph/served.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace carousel::config {

namespace {

constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();

/// Enters the resources of a group of packet processes, the first of which is `first`. Returns what is wrong with its
/// key `serves`, or nothing.
std::string serve(Graph& graph, std::uint32_t first, std::uint32_t resources) {
  const GraphNode& drawn = *graph.nodes[first].drawn;
  const auto name = [&](std::uint32_t node) -> const std::string& { return graph.nodes[node].name; };
  const auto count = static_cast<std::size_t>(drawn.count.value_or(1));
  std::string error;
  const std::vector<std::uint32_t> served = graph.names.find(drawn.serves, error);
  if (served.empty()) return error;
  if (served.size() % count != 0)
    return fmt::format("each of {0} packet processes serves as many; expected a multiple of {0} resources, found {1}",
                       count, served.size());
  for (std::size_t i = 0; i < served.size(); ++i) {
    if (served[i] >= resources)
      return fmt::format("a packet_process keeps the collections of resources; expected such nodes, found {}",
                         name(served[i]));
    std::uint32_t& manager = graph.manager_of[served[i]];
    if (manager != kNobody)
      return fmt::format("{} serves {} already; expected one packet_process for each resource", name(manager),
                         name(served[i]));
    manager = first + static_cast<std::uint32_t>(i / (served.size() / count));
  }
  return "";
}

}  // namespace

void find_served(const TopologyConfig& config, Graph& graph, std::vector<GraphIssue>& issues) {
  if (is_central(config)) return;  // units of two kinds, which check_graph() refuses
  const auto resources = static_cast<std::uint32_t>(graph.resources - managers_of(config));
  graph.manager_of.assign(graph.resources, kNobody);
  const std::size_t before = issues.size();
  for (std::uint32_t node = resources; node < graph.resources;) {
    const std::size_t entry = graph.nodes[node].entry;
    if (std::string wrong = serve(graph, node, resources); !wrong.empty())
      issues.push_back({fmt::format("topology.nodes.{}.serves", entry), std::move(wrong)});
    for (; node < graph.resources && graph.nodes[node].entry == entry; ++node) graph.manager_of[node] = node;
  }
  const auto left = std::ranges::find(graph.manager_of, kNobody);
  if (issues.size() > before || left == graph.manager_of.end()) return;  // the ones left are those of a wrong name
  issues.push_back(
      {"topology.nodes", fmt::format("no packet_process serves {}; expected one that does, as the others have one",
                                     graph.nodes[static_cast<std::size_t>(left - graph.manager_of.begin())].name)});
}

std::vector<std::uint32_t> Graph::issuers() const {
  std::vector<std::uint32_t> out;
  for (std::uint32_t r = 0; r < resources; ++r)
    if (manager_of.empty() || manager_of[r] == r) out.push_back(r);
  return out;
}

}  // namespace carousel::config
