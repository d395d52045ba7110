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

StopRing stop_ring(const TopologyConfig& config, const Graph& graph) {
  StopRing ring;
  ring.entry = *stop_ring_entry(config);
  ring.drawn = &config.links[ring.entry];
  const std::size_t step = ring.directions() * ring.rings();
  for (std::size_t i = 0; i < graph.links.size(); i += step) ring.nodes.push_back(graph.links[i].from);
  ring.latency_cycles = graph.links.front().latency_cycles;
  ring.bytes_per_cycle = graph.links.front().bytes_per_cycle;
  return ring;
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
