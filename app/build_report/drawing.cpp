#include "app/build_report/drawing.h"

#include "core/config/graph/graph.h"

namespace carousel::app {

std::optional<std::vector<report::DrawnNode>> drawing(const Config& config) {
  if (config.topology.shape != TopologyShape::kGraph) return std::nullopt;
  std::vector<config::GraphIssue> issues;  // none in a configuration that has run
  const config::Graph graph = config::draw_graph(config.topology, issues);
  std::vector<report::DrawnNode> out;
  for (const config::Graph::Node& node : graph.nodes) {
    report::DrawnNode& one = out.emplace_back(report::DrawnNode{node.name});
    if (!node.at.given) continue;
    one.x_mm = node.at.x;
    one.y_mm = node.at.y;
  }
  return out;
}

}  // namespace carousel::app
