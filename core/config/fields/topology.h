#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/fields/engine_kind.h"
#include "core/config/fields/field.h"
#include "core/config/fields/graph.h"
#include "core/config/fields/own_keys.h"
#include "core/config/fields/queue_kind.h"
#include "core/config/fields/testers.h"

namespace carousel {

enum class TopologyShape {
  kRing,
  kBidirectional,
  kMultiRing,
  kHierarchical,
  kPointToPoint,
  kBus,
  kCentral,
  kIndependent,
  kGraph
};
template <>
inline constexpr auto kEnumNames<TopologyShape> = [] {
  using enum TopologyShape;
  return names<TopologyShape>({{kRing, "ring"},
                               {kBidirectional, "bidirectional"},
                               {kMultiRing, "multi_ring"},
                               {kHierarchical, "hierarchical"},
                               {kPointToPoint, "point_to_point"},
                               {kBus, "bus"},
                               {kCentral, "central"},
                               {kIndependent, "independent"},
                               {kGraph, "graph"}});
}();

/// Properties of a shape that do not depend on numbers. Its wires and its rule against deadlock are its plan's
/// (ringbus/topology).
struct ShapeProperties {
  bool has_packets = true;       ///< resources exchange packets; otherwise each traces its own rays, without links
  bool carries_traffic = false;  ///< synthetic traffic runs on it
};

/// Whether rays of a network that is drawn go through the tree in packets, or each resource traces its own.
enum class Tracing { kPackets, kStacks };
template <>
inline constexpr auto kEnumNames<Tracing> = [] {
  using enum Tracing;
  return names<Tracing>({{kPackets, "packets"}, {kStacks, "stacks"}});
}();

constexpr ShapeProperties properties_of(TopologyShape shape) {
  using enum TopologyShape;
  switch (shape) {
    case kRing:
    case kBidirectional:
    case kMultiRing:
    case kPointToPoint:
    case kHierarchical:
    case kGraph:
      return {.carries_traffic = true};
    case kIndependent:
      return {.has_packets = false};
    case kBus:
    case kCentral:
      break;
  }
  return {};
}

enum class CentralForm { kCells, kDistributor };
template <>
inline constexpr auto kEnumNames<CentralForm> = [] {
  using enum CentralForm;
  return names<CentralForm>({{kCells, "cells"}, {kDistributor, "distributor"}});
}();

enum class Visit { kAll, kOwners };
template <>
inline constexpr auto kEnumNames<Visit> = [] {
  using enum Visit;
  return names<Visit>({{kAll, "all"}, {kOwners, "owners"}});
}();

enum class Flow { kCredits, kBubble, kNone };
template <>
inline constexpr auto kEnumNames<Flow> = [] {
  using enum Flow;
  return names<Flow>({{kCredits, "credits"}, {kBubble, "bubble"}, {kNone, "none"}});
}();

struct LinkConfig {
  QueueKind queue = QueueKind::kSpscRing;
  std::int64_t depth = 16;
  std::int64_t latency_cycles = 4;
  std::int64_t bytes_per_cycle = 32;
  std::int64_t virtual_channels = 1;
};

/// The keys that differ in one resource, or in nodes of a graph.
struct ResourceOverride {
  static constexpr std::string_view kRequired = "";
  static constexpr std::string_view kRowPath = "";  ///< the keys of its testers are those of the whole machine

  std::optional<std::int64_t> resource;
  TestersConfig testers;
  std::string nodes{};
  OwnKeys own{};
  std::vector<std::int64_t> named{};  ///< the resources that `nodes` names, once the graph has been read

  bool is_about(std::int64_t number) const {
    return resource == number || std::find(named.begin(), named.end(), number) != named.end();
  }
};

struct TopologyConfig {
  std::int64_t resources = 8;
  TopologyShape shape = TopologyShape::kRing;
  std::int64_t rings = 2;
  std::int64_t groups = 4;
  CentralForm form = CentralForm::kCells;
  Tracing trace = Tracing::kPackets;  ///< of a graph
  Visit visit = Visit::kAll;
  Flow flow = Flow::kCredits;
  LinkConfig link;
  std::vector<ResourceOverride> overrides;
  std::vector<GraphNode> nodes;  ///< of a graph
  std::vector<GraphLink> links;  ///< likewise
  Routing routes = Routing::kShortest;
  std::string root;
  std::vector<GraphWay> ways;
  Tour tour = Tour::kNames;
  ChannelRule channels = ChannelRule::kAny;
  std::int64_t core_mhz = 1000;          ///< engine.clock_mhz, once the configuration has been read
  std::int64_t synchroniser_cycles = 0;  ///< clocks.synchroniser_cycles, likewise
};

/// The properties of the configured network: the resources of a graph trace their own rays where it says so.
constexpr ShapeProperties properties_of(const TopologyConfig& c) {
  if (c.shape == TopologyShape::kGraph && c.trace == Tracing::kStacks) return {.has_packets = false};
  return properties_of(c.shape);
}

/// What a network without packets calls itself in messages, for example "topology.shape: independent".
constexpr std::string_view without_packets(const TopologyConfig& c) {
  return c.shape == TopologyShape::kGraph ? "topology.trace: stacks" : "topology.shape: independent";
}

/// A packet_process that keeps the collections of resources; they own the rays and the testers, and it has none.
inline bool is_manager(const GraphNode& node) {
  return node.kind == GraphNodeKind::kPacketProcess && !node.serves.empty();
}

/// Caches are nodes of the graph.
inline bool has_drawn_caches(const TopologyConfig& c) {
  return c.shape == TopologyShape::kGraph &&
         std::ranges::any_of(c.nodes, [](const GraphNode& node) { return node.kind == GraphNodeKind::kCache; });
}

/// A machine of units that hold rays, collections and all testers (US 9633468): the shape, or a graph of such units.
inline bool is_central(const TopologyConfig& c) {
  if (c.shape != TopologyShape::kGraph) return c.shape == TopologyShape::kCentral;
  return std::ranges::any_of(
      c.nodes, [](const GraphNode& node) { return node.kind == GraphNodeKind::kPacketProcess && !is_manager(node); });
}

/// The packet processes of a graph that keep the collections of resources (US 9633468 with more than one unit).
inline std::int64_t managers_of(const TopologyConfig& c) {
  std::int64_t sum = 0;
  for (const GraphNode& node : c.nodes)
    if (c.shape == TopologyShape::kGraph && is_manager(node)) sum += node.count.value_or(1);
  return sum;
}

/// The resources that own rays, which have the first numbers; the others are packet processes.
inline std::int64_t ray_owners(const TopologyConfig& c) {
  return c.resources - managers_of(c);
}

/// The pools of shader workers that a graph draws.
struct DrawnPools {
  std::int64_t pools = 0;    ///< nodes of the kind shading
  std::int64_t silent = 0;   ///< of these, those that name no number of workers
  std::int64_t workers = 0;  ///< of all others
};
inline DrawnPools drawn_pools(const TopologyConfig& c) {
  DrawnPools out;
  for (const GraphNode& node : c.nodes) {
    if (c.shape != TopologyShape::kGraph || node.kind != GraphNodeKind::kShading) continue;
    const std::int64_t count = node.count.value_or(1);
    out.pools += count;
    (node.workers ? out.workers : out.silent) += node.workers.value_or(1) * count;
  }
  return out;
}

/// A bus is the network that packets travel: the shape, or a graph around one.
inline bool is_bus(const TopologyConfig& c) {
  if (c.shape != TopologyShape::kGraph) return c.shape == TopologyShape::kBus;
  return std::ranges::any_of(c.nodes, [](const GraphNode& node) { return node.kind == GraphNodeKind::kBus; });
}

/// One entry of the configuration that lets some resources differ from the others: an override, or a node of a graph.
struct OwnOf {
  const ResourceOverride* override = nullptr;  ///< null: a node of a graph says so
  std::int64_t first = 0, count = 0;           ///< of the resources of that node
  const TestersConfig* testers = nullptr;      ///< null: those of the whole machine
  const OwnKeys* keys = nullptr;               ///< never null
  std::size_t entry = 0;                       ///< its place in topology.overrides, or in topology.nodes

  bool is_about(std::int64_t resource) const {
    return override != nullptr ? override->is_about(resource) : resource >= first && resource < first + count;
  }
};

/// Calls `body` with the OwnOf of each such entry: first those of the nodes of a graph, then those of the overrides.
template <class Body>
void for_each_own(const TopologyConfig& topology, const Body& body) {
  std::int64_t first = 0;
  for (std::size_t i = 0; i < topology.nodes.size() && topology.shape == TopologyShape::kGraph; ++i) {
    const GraphNode& node = topology.nodes[i];
    if (node.kind != GraphNodeKind::kResource) continue;
    const std::int64_t count = node.count.value_or(1);
    if (node.testers || node.own != OwnKeys{})
      body(OwnOf{nullptr, first, count, node.testers ? &*node.testers : nullptr, &node.own, i});
    first += count;
  }
  for (std::size_t i = 0; i < topology.overrides.size(); ++i)
    body(OwnOf{&topology.overrides[i], 0, 0, &topology.overrides[i].testers, &topology.overrides[i].own, i});
}

/// Tells whether `test` holds for one of these entries.
template <class Test>
bool any_own(const TopologyConfig& topology, const Test& test) {
  bool any = false;
  for_each_own(topology, [&](const OwnOf& one) { any = any || test(one); });
  return any;
}

/// Tells whether some resource differs from the others.
inline bool has_own(const TopologyConfig& topology) {
  return any_own(topology, [](const OwnOf&) { return true; });
}

/// The path of the entry in the configuration.
inline std::string own_place(const OwnOf& one) {
  return (one.override != nullptr ? "topology.overrides." : "topology.nodes.") + std::to_string(one.entry);
}

namespace config {

template <class V>
void describe(V& v, LinkConfig& c) {
  v.choice("queue", c.queue, "The queue that carries a link in the native engine.")
      .only(EngineKind::kNative, "real queues");
  v.field("depth", c.depth, IntRange{1, 65536}, "packets", "The number of packets that a link holds.")
      .relax("packets_in_flight", Better::kTwice);
  v.field("latency_cycles", c.latency_cycles, kCycles, "cycles", "The time that a packet takes over a link.")
      .relax("link_latency", Better::kHalf);
  v.field("bytes_per_cycle", c.bytes_per_cycle, IntRange{1, 65536}, "bytes/cycle", "The width of a link.")
      .relax("link_bandwidth", Better::kTwice);
  v.field("virtual_channels", c.virtual_channels, kChannels, "channels",
          "The queues of `depth` places that share a link of a graph, under synthetic traffic.");
}

template <class V>
void describe(V& v, ResourceOverride& c) {
  v.field_or_auto("resource", c.resource, IntRange{0, kMaxResources - 1}, "",
                  "The number of the resource; auto: nodes says which.");
  v.field("nodes", c.nodes, "", "Resources of a graph by name, such as r[0..3].");
  describe(v, c.own);
  v.section("testers", c.testers, "Its testers. A key that is not given is as in `testers` of the whole machine.");
}

template <class V>
void describe(V& v, TopologyConfig& c) {
  v.field("resources", c.resources, IntRange{1, kMaxResources}, "resources", "The number of compute resources.");
  v.choice("shape", c.shape, "The network that links the resources; a graph is drawn by nodes and links.")
      .relax("ring_directions", TopologyShape::kBidirectional, Relaxed{.times = 0},
             c.shape == TopologyShape::kRing && c.resources > 1)
      .only(EngineKind::kCycle, "", TopologyShape::kMultiRing, TopologyShape::kHierarchical, TopologyShape::kBus,
            TopologyShape::kIndependent, TopologyShape::kCentral);
  v.field("rings", c.rings, IntRange{1, 64}, "rings", "The number of rings of a multi_ring.")
      .relax("rings", Better::kTwice, Relaxed{.times = 0});
  v.field("groups", c.groups, IntRange{1, kMaxResources}, "groups", "The number of groups of a hierarchical network.");
  v.choice("form", c.form,
           "The form of a central machine, or of each packet_process of a graph: test cells (testers.simd.lanes), each "
           "for the rays of its places in ray memory, or testers behind a distributor (testers.distributor).");
  v.choice("trace", c.trace,
           "Rays of a graph go through the tree in packets of those that are at one node, over its links; or each "
           "resource traces its own rays depth first, with a stack for each, as with topology.shape: independent.")
      .only(EngineKind::kCycle, "", Tracing::kStacks);
  v.choice("visit", c.visit,
           "A packet is handled by all resources, or only by the owners of its rays, which point_to_point and graph "
           "imply.");
  v.choice("flow", c.flow, "The rule that keeps the links from filling up. The value none needs --force.");
  v.section("link", c.link, "Properties of every link.");
  v.list("overrides", c.overrides, "Resources that differ from the rest.");
  v.list("nodes", c.nodes, "The nodes of a graph. Its resources are numbered in this order.");
  v.list("links", c.links, "The links of a graph, one by one or by pattern.");
  v.choice("routes", c.routes,
           "The ways through a graph: the shortest by the latency of links; up_down, which first go up a tree and then "
           "down; given, and the shortest where `ways` say nothing; or those of a plugin's router.");
  v.field("root", c.root, "", "The node at the top for up_down; without it, the one that is nearest to all others.");
  v.list("ways", c.ways, "The ways that are given.");
  v.choice("tour", c.tour,
           "The order in which a packet visits resources of a graph: that of their names in `nodes`, or from each to "
           "the nearest that is left by the links of its lane, the first at the beginning.");
  v.choice(
      "channels", c.channels,
      "The virtual channel that a packet takes: any; those of a class that counts the datelines it has passed; "
      "or those of a class that counts its links. With none, links have no channels: each lane is a ring, a packet "
      "keeps its lane, and `flow` keeps the ring from filling up; or links lead straight to every resource.");
}

}  // namespace config
}  // namespace carousel
