#include "core/config/graph/ring.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "core/config/graph/node_names.h"

namespace carousel::config {

std::optional<std::size_t> stop_ring_entry(const TopologyConfig& config) {
  if (config.shape != TopologyShape::kGraph) return std::nullopt;
  const auto found = std::find_if(config.links.begin(), config.links.end(), has_stops);
  if (found == config.links.end()) return std::nullopt;
  return static_cast<std::size_t>(found - config.links.begin());
}

std::optional<std::size_t> lone_stop_ring_entry(const TopologyConfig& config) {
  const std::optional<std::size_t> ring = stop_ring_entry(config);
  const auto packets = std::ranges::count_if(
      config.links, [](const GraphLink& link) { return std::ranges::count(link.carries, Carried::kPackets) > 0; });
  return packets == 1 ? ring : std::nullopt;
}

std::vector<StopRing> stop_rings(const TopologyConfig& config, const Graph& graph) {
  std::vector<StopRing> out;
  if (config.shape != TopologyShape::kGraph) return out;
  for (std::size_t i = 0; i < graph.links.size(); ++i) {
    const Graph::Link& link = graph.links[i];
    const GraphLink& drawn = config.links[link.entry];
    if (!has_stops(drawn)) continue;
    if (out.empty() || out.back().entry != link.entry) {
      StopRing& ring = out.emplace_back();
      ring.entry = link.entry;
      ring.drawn = &drawn;
      ring.first = i;
      ring.latency_cycles = link.latency_cycles;
      ring.bytes_per_cycle = link.bytes_per_cycle;
    }
    StopRing& ring = out.back();
    if ((i - ring.first) % (ring.directions() * ring.rings()) == 0) ring.nodes.push_back(link.from);
  }
  return out;
}

std::vector<std::optional<std::size_t>> plain_stops(const TopologyConfig& config, const Graph& graph) {
  std::vector<std::optional<std::size_t>> out(graph.nodes.size());
  std::vector<bool> others(graph.nodes.size());
  for (const Graph::Link& link : graph.links) {
    if (!link.carries_any({Carried::kPackets})) continue;
    const bool stops = has_stops(config.links[link.entry]);
    for (const std::uint32_t node : {link.from, link.to}) {
      others[node] = others[node] || !stops || out[node].value_or(link.entry) != link.entry;
      if (stops) out[node] = link.entry;
    }
  }
  for (std::size_t i = 0; i < out.size(); ++i)
    if (others[i]) out[i].reset();
  return out;
}

std::vector<std::uint32_t> named_resources(const TopologyConfig& config, const std::string& pattern,
                                           std::string& error) {
  if (pattern.empty()) {
    std::vector<std::uint32_t> all(static_cast<std::size_t>(config.resources));
    std::iota(all.begin(), all.end(), 0u);
    return all;
  }
  NodeNames names;
  std::uint32_t resources = 0;
  for (const GraphNode& node : config.nodes)
    if (takes_packets(node.kind) && names.add(node.name, resources, node.count))
      resources += static_cast<std::uint32_t>(node.count.value_or(1));
  return names.find(pattern, error);
}

}  // namespace carousel::config
