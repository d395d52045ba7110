#include "ringbus/topology/drawn_shape.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace carousel::ringbus {

namespace {

GraphNode drawn_group(const char* name, std::int64_t count) {
  GraphNode node;
  node.name = name;
  node.count = count;
  return node;
}

GraphNode drawn_node(const char* name, GraphNodeKind kind) {
  GraphNode node;
  node.name = name;
  node.kind = kind;
  return node;
}

GraphLink ring_of(std::string nodes) {
  GraphLink link;
  link.ring = std::move(nodes);
  return link;
}

/// One medium that all resources share and hear. The way to the bus takes half of the link's latency, the way from it
/// the other half, each at least a cycle.
void draw_bus(TopologyConfig& out) {
  out.nodes.push_back(drawn_node("bus", GraphNodeKind::kBus));
  const std::int64_t there = std::max<std::int64_t>(1, out.link.latency_cycles / 2);
  const std::int64_t back = std::max<std::int64_t>(1, out.link.latency_cycles - there);
  GraphLink link;
  link.from = "r[*]";
  link.to = "bus";
  link.latency_cycles = there;
  link.both = there == back;
  out.links = {link};
  if (link.both) return;
  std::swap(link.from, link.to);
  link.latency_cycles = back;
  out.links.push_back(link);
}

/// Two rings, each for the packets of a lane, which visit resources in the order of their ring.
void draw_two_ways(TopologyConfig& out, std::int64_t resources) {
  out.links = {ring_of("r[*]"), ring_of(resources == 2 ? "r[*]" : fmt::format("r[0], r[{}..1]", resources - 1))};
  out.links[0].lane = 0;
  out.links[1].lane = 1;
  out.tour = Tour::kNearest;
}

/// Draws lines from each bridge through its group and back, and the ring of bridges.
///
/// A packet goes through the rest of its own group, then round the bridges and into the groups that want it, and at
/// last into its own group again. A bridge has room for all packets there are, so that neither ring waits for the
/// other.
void draw_bridges(std::int64_t resources, std::int64_t groups, TopologyConfig& out) {
  GraphNode& bridges = out.nodes.emplace_back(drawn_group("bridge", groups));
  bridges.kind = GraphNodeKind::kRouter;
  bridges.forward = Forward::kWhole;
  const auto first_of = [&](std::int64_t group) { return (group * resources + groups - 1) / groups; };
  for (std::int64_t g = 0; g < groups; ++g) {
    const std::int64_t first = first_of(g), last = first_of(g + 1) - 1;
    out.links.push_back(ring_of(first == last ? fmt::format("bridge[{}], r[{}]", g, first)
                                              : fmt::format("bridge[{}], r[{}..{}]", g, first, last)));
    if (groups == 1) continue;
    GraphLink& next = out.links.emplace_back();
    next.from = fmt::format("bridge[{}]", g);
    next.to = fmt::format("bridge[{}]", (g + 1) % groups);
  }
}

}  // namespace

DrawnShape draw_shape(const TopologyConfig& config, bool traffic) {
  DrawnShape out{config, true, ""};
  if (config.shape == TopologyShape::kGraph) return out;
  const bool links = config.resources > 1;
  out.config.shape = TopologyShape::kGraph;
  out.config.nodes = {drawn_group("r", config.resources)};
  out.config.links.clear();
  out.config.trace = Tracing::kPackets;
  // Other shapes do not follow these keys of graphs.
  out.config.routes = Routing::kShortest;
  out.config.tour = Tour::kNames;
  out.config.root.clear();
  out.config.ways.clear();
  if (traffic && config.shape != TopologyShape::kHierarchical) {
    out.config.channels = ChannelRule::kNone;
    out.config.link.virtual_channels = 1;
  }
  switch (config.shape) {
    case TopologyShape::kRing:
      if (links) out.config.links = {ring_of("r[*]")};
      break;
    case TopologyShape::kBidirectional:
      if (links) draw_two_ways(out.config, config.resources);
      break;
    case TopologyShape::kHierarchical:
      if (links) draw_bridges(config.resources, std::min(config.groups, config.resources), out.config);
      break;
    case TopologyShape::kPointToPoint:
      if (links) {
        GraphLink& all = out.config.links.emplace_back();
        all.from = all.all_to = "r[*]";
      }
      out.same = config.resources != 2;
      out.difference =
          "two resources of the shape have room for all packets, and two of the graph, which are a ring, "
          "have credits";
      break;
    case TopologyShape::kMultiRing:
      if (links) (out.config.links = {ring_of("r[*]")}).front().lanes = config.rings;
      break;
    case TopologyShape::kBus:
      if (links) draw_bus(out.config);
      break;
    case TopologyShape::kCentral:
      out.config.nodes = {drawn_node("unit", GraphNodeKind::kPacketProcess)};
      break;
    case TopologyShape::kIndependent:
      out.config.trace = Tracing::kStacks;
      break;
    case TopologyShape::kGraph:
      break;
  }
  return out;
}

}  // namespace carousel::ringbus
