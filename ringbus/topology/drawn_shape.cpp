#include "ringbus/topology/drawn_shape.h"

#include <fmt/format.h>

#include "ringbus/topology/topology.h"

namespace carousel::ringbus {

namespace {

GraphNode drawn_group(const char* name, std::size_t count) {
  GraphNode node;
  node.name = name;
  node.count = static_cast<std::int64_t>(count);
  return node;
}

GraphLink ring_of(std::string nodes) {
  GraphLink link;
  link.ring = std::move(nodes);
  return link;
}

/// Lines from each bridge through its group and back, and the ring of bridges.
void draw_bridges(const Topology& topology, TopologyConfig& out) {
  GraphNode& bridges = out.nodes.emplace_back(drawn_group("bridge", topology.groups().size()));
  bridges.kind = GraphNodeKind::kRouter;
  bridges.forward = Forward::kWhole;
  for (std::size_t g = 0; g < topology.groups().size(); ++g) {
    const auto [first, last] = topology.groups()[g];
    out.links.push_back(ring_of(first == last ? fmt::format("bridge[{}], r[{}]", g, first.value)
                                              : fmt::format("bridge[{}], r[{}..{}]", g, first.value, last.value)));
    if (topology.groups().size() == 1) continue;
    GraphLink& next = out.links.emplace_back();
    next.from = fmt::format("bridge[{}]", g);
    next.to = fmt::format("bridge[{}]", (g + 1) % topology.groups().size());
  }
}

}  // namespace

DrawnShape draw_shape(const TopologyConfig& config) {
  DrawnShape out{config, true, true, ""};
  if (config.shape == TopologyShape::kGraph) return out;
  const Topology topology(config);
  out.config.shape = TopologyShape::kGraph;
  out.config.nodes = {drawn_group("r", topology.resources())};
  out.config.links.clear();
  switch (config.shape) {
    case TopologyShape::kRing:
      if (topology.resources() > 1) out.config.links = {ring_of("r[*]")};
      break;
    case TopologyShape::kBidirectional:
      if (topology.resources() > 1) (out.config.links = {ring_of("r[*]")}).front().both = true;
      out.same = topology.resources() == 1;
      out.difference =
          "a packet of the shape goes all the way round in one direction, and one of the graph takes the "
          "shortest way to its next stop";
      break;
    case TopologyShape::kHierarchical:
      if (topology.resources() > 1) draw_bridges(topology, out.config);
      break;
    case TopologyShape::kPointToPoint:
      if (topology.resources() > 1) {
        GraphLink& all = out.config.links.emplace_back();
        all.from = all.all_to = "r[*]";
      }
      out.same = topology.resources() != 2;
      out.difference =
          "two resources of the shape have room for all packets, and two of the graph, which are a ring, "
          "have credits";
      break;
    case TopologyShape::kMultiRing:
      out.possible = out.same = false;
      out.difference = "its rings are links side by side between the same nodes, and a graph has one from node to node";
      break;
    case TopologyShape::kBus:
      out.possible = out.same = false;
      out.difference = "a bus is one medium that all resources hear, and a link leads from one node to another";
      break;
    case TopologyShape::kCentral:
    case TopologyShape::kIndependent:
      out.possible = out.same = false;
      out.difference = "it has no links";
      break;
    case TopologyShape::kGraph:
      break;
  }
  return out;
}

}  // namespace carousel::ringbus
