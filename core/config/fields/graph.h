#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/fields/field.h"
#include "core/config/fields/own_keys.h"
#include "core/config/fields/queue_kind.h"
#include "core/config/fields/testers.h"

namespace carousel {

/// The kinds of nodes of a network that is drawn (`topology.shape: graph`).
enum class GraphNodeKind { kResource, kPacketProcess, kRouter, kBus, kCache, kMemory, kShading };
template <>
inline constexpr auto kEnumNames<GraphNodeKind> = [] {
  using enum GraphNodeKind;
  return names<GraphNodeKind>({{kResource, "resource"},
                               {kPacketProcess, "packet_process"},
                               {kRouter, "router"},
                               {kBus, "bus"},
                               {kCache, "cache"},
                               {kMemory, "memory"},
                               {kShading, "shading"}});
}();

/// Tells whether packets stop at nodes of the kind: where rays are, or their collections.
constexpr bool takes_packets(GraphNodeKind kind) {
  return kind == GraphNodeKind::kResource || kind == GraphNodeKind::kPacketProcess;
}

/// The kinds of messages that may travel over a link.
enum class Carried { kPackets, kShapes, kNewRays, kCompletedRays };
template <>
inline constexpr auto kEnumNames<Carried> = [] {
  using enum Carried;
  return names<Carried>(
      {{kPackets, "packets"}, {kShapes, "shapes"}, {kNewRays, "new_rays"}, {kCompletedRays, "completed_rays"}});
}();

/// The time at which a router sends a packet on.
enum class Forward { kHead, kWhole };
template <>
inline constexpr auto kEnumNames<Forward> = [] {
  using enum Forward;
  return names<Forward>({{kHead, "head"}, {kWhole, "whole"}});
}();

/// A place on the die, or a distance; none by default.
struct GraphPoint {
  double x = 0, y = 0;
  bool given = false;

  friend bool operator==(const GraphPoint&, const GraphPoint&) = default;
};

/// The rule by which ways through a graph are found. Plugins add others (core/types/router_rule.h).
enum class Routing { kShortest, kUpDown, kGiven };
template <>
inline constexpr auto kEnumNames<Routing> = [] {
  using enum Routing;
  return names<Routing>({{kShortest, "shortest"}, {kUpDown, "up_down"}, {kGiven, "given"}});
}();

template <>
inline constexpr std::string_view kAddedAs<Routing> = "router";

/// The order in which a packet visits the owners of its rays.
enum class Tour { kNames, kNearest };
template <>
inline constexpr auto kEnumNames<Tour> = [] {
  using enum Tour;
  return names<Tour>({{kNames, "names"}, {kNearest, "nearest"}});
}();

/// The rule by which a packet takes one of a link's virtual channels.
enum class ChannelRule { kAny, kDateline, kHops, kNone };
template <>
inline constexpr auto kEnumNames<ChannelRule> = [] {
  using enum ChannelRule;
  return names<ChannelRule>({{kAny, "any"}, {kDateline, "dateline"}, {kHops, "hops"}, {kNone, "none"}});
}();

/// A part of the ways that are given: a whole way, or the next node for some nodes and destinations.
struct GraphWay {
  static constexpr std::string_view kRequired = "";
  static constexpr std::string_view kRowPath = "";

  std::string along, at, to, next;

  friend bool operator==(const GraphWay&, const GraphWay&) = default;
};

/// A node of the graph, or a group of equal ones.
struct GraphNode {
  static constexpr std::string_view kRequired = "name";
  static constexpr std::string_view kRowPath = "";  ///< the keys of its testers are those of the whole machine

  std::string name;
  GraphNodeKind kind = GraphNodeKind::kResource;
  std::optional<std::int64_t> count;
  std::int64_t latency_cycles = 0;
  std::optional<std::int64_t> buffers;
  Forward forward = Forward::kHead;
  /// Empty: of a cache, all resources; of a packet_process, its own cells or testers; of shading, those to which it is
  /// nearest.
  std::string serves;
  std::optional<std::int64_t> workers;  ///< of shading; absent: a share of those that no other pool names
  std::optional<std::int64_t> interleave_bytes;
  std::int64_t credit_cycles = 0, claim_cycles = 0;
  GraphPoint at, step;
  std::optional<std::int64_t> columns;
  std::string clock{};   ///< empty: as clocks.noc and the kind say
  std::int64_t mhz = 0;  ///< of that clock, once the configuration has been read; 0: the clock of the resources
  OwnKeys own{};         ///< of resources
  std::optional<TestersConfig> testers{};

  friend bool operator==(const GraphNode&, const GraphNode&) = default;
};

/// Columns and rows of a mesh; none by default.
struct GridSize {
  std::int64_t columns = 0, rows = 0;

  bool any() const { return columns > 0; }
  friend bool operator==(const GridSize&, const GridSize&) = default;
};

/// The stops of a drawn ring: what happens where a packet gets onto the ring, passes, and leaves it.
struct RingStops {
  enum class Rule { kQueues, kSlots, kGrants } rule = Rule::kQueues;
  std::int64_t rings = 1;
  std::optional<std::int64_t> port_bytes_per_cycle;
  std::int64_t fair_after_cycles = 0;
  std::int64_t grant_cycles = 1;
  std::int64_t command_cycles = 0;
  std::int64_t start_cycles = 1;
  std::optional<std::int64_t> transfers;

  friend bool operator==(const RingStops&, const RingStops&) = default;
};

template <>
inline constexpr auto kEnumNames<RingStops::Rule> = [] {
  using enum RingStops::Rule;
  return names<RingStops::Rule>({{kQueues, "queues"}, {kSlots, "slots"}, {kGrants, "grants"}});
}();

/// A link of the graph, or a pattern of links that are alike.
struct GraphLink {
  static constexpr std::string_view kRequired = "";
  static constexpr std::string_view kRowPath = "topology.link";  ///< what it does not say is said there

  std::string from, to, all_to, ring, line, of;
  GridSize mesh;
  bool both = false, dateline = false;
  std::optional<std::int64_t> latency_cycles, bytes_per_cycle, depth, virtual_channels;
  std::optional<std::int64_t> lane;  ///< absent: of all packets
  std::int64_t lanes = 1;
  std::vector<Carried> carries{Carried::kPackets};
  RingStops stops;
  std::optional<QueueKind> queue{};
  std::string clock{};   ///< empty: clocks.noc
  std::int64_t mhz = 0;  ///< of that clock, once the configuration has been read; 0: the clock of the resources

  friend bool operator==(const GraphLink&, const GraphLink&) = default;
};

namespace config {

inline constexpr IntRange kChannels{1, 64};
inline constexpr std::int64_t kMaxLanes = 64;
inline constexpr RealRange kDiePlace{-1000, 1000};

/// A number of one pool of workers, by the key of the whole machine.
struct PoolKey {
  std::string_view name;
  const char* path;
  IntRange range;
  const char *unit, *meaning;
};
inline constexpr PoolKey kPoolWorkers{
    "workers", "shading.workers", IntRange{1, 256}, "workers",
    "The workers of each node of the kind shading. With auto these nodes have equal shares of the workers of "
    "shading.workers that others do not name, and the first ones the rest."};

template <class V>
void describe(V& v, GraphWay& c) {
  v.field("along", c.along, "", "The nodes of a way in order, the last of them its destination.");
  v.field("at", c.at, "", "In place of a way: nodes at which a packet is.");
  v.field("to", c.to, "", "Its destinations, which are resources.");
  v.field("next", c.next, "", "The node to which it goes on, by a link.");
}

template <class V>
void describe(V& v, GraphNode& c) {
  v.field("name", c.name, "", "The name of the node, or of the group.");
  v.choice(
      "kind", c.kind,
      "A compute resource; a packet_process, which is a unit of a central machine with its test cells or testers, or "
      "keeps the collections of the resources that it serves; a router, which only passes packets on; a bus, one "
      "medium "
      "that all resources hear; a cache, an L2 or a bank of one; a memory behind the caches; or shading, with ray "
      "control.");
  v.field_or_auto("count", c.count, IntRange{1, kMaxResources}, "nodes",
                  "The number of nodes of a group, called name[0] and on; auto is one node of that very name.");
  v.field("latency_cycles", c.latency_cycles, IntRange{0, 1'000'000}, "cycles",
          "The time that the node takes before a packet leaves by a link, besides the link's.");
  v.field_or_auto(
      "buffers", c.buffers, IntRange{1, 65536}, "packets",
      "The places of a router for each link that leaves it, and for packets that get off a ring of slots there; auto "
      "is room for all packets there are.");
  v.choice("forward", c.forward,
           "A router sends a packet on when its head has come, if the next link is as wide, or the whole packet.");
  v.field(
      "serves", c.serves, "",
      "The resources that ask a cache, such as r[0..7]; left out, all. The nodes of a group hold lines in turn. Or "
      "the resources whose rays a packet_process collects, or whose completed rays come to the workers of a node of "
      "the kind shading: of a group, each serves an equal run of them. Left out at shading, they are those to which "
      "it is the nearest such node in time; of several as near, the first takes them.");
  v.own_key(kPoolWorkers, c.workers).relax("shading", Better::kTwice);
  v.field_or_auto("interleave_bytes", c.interleave_bytes, IntRange{16, 1 << 20}, "bytes",
                  "The bytes that a cache of a group, or a memory, holds before the next one's turn; auto is a line.");
  v.field("credit_cycles", c.credit_cycles, IntRange{0, 1'000'000}, "cycles",
          "The time that a free place of the node takes to be told on, besides the link's latency.");
  v.field("claim_cycles", c.claim_cycles, IntRange{0, 1'000'000}, "cycles",
          "The part of latency_cycles in which the first packet of a queue claims a channel of its next link, under "
          "synthetic traffic. It begins when the packet before it has left.");
  v.field("at", c.at, kDiePlace, "mm", "The place of the node on the die, x and y; of a group, that of the first.");
  v.field("step", c.step, kDiePlace, "mm", "From a node of a group to the next in its row and in its column.");
  v.field_or_auto("columns", c.columns, IntRange{1, kMaxResources}, "nodes",
                  "The nodes in a row of a group that has places; auto is all of them.");
  v.field(
      "clock", c.clock, "",
      "The clock, a name of `clocks`, by which a router passes messages on, and a memory moves lines and spends the "
      "half of its latency on the way back. With synthetic traffic resources have one, too. Left out, noc at a "
      "router, and with synthetic traffic at every node, and core elsewhere.");
  describe(v, c.own);
  v.section("testers", c.testers,
            "The testers of these resources. A key that is not given is as in `testers` of the whole machine.");
}

template <class V>
void describe(V& v, RingStops& c) {
  v.choice("rule", c.rule,
           "Packets wait in queues at the nodes of the ring. Or they ride in slots that nothing holds up, and get on "
           "where a free slot passes. Or an arbiter grants a packet its whole way.");
  v.field("rings", c.rings, IntRange{1, 16}, "rings",
          "The rings side by side in each direction, with slots or grants.");
  v.field_or_auto("port_bytes_per_cycle", c.port_bytes_per_cycle, IntRange{1, 65536}, "bytes/cycle",
                  "The width of a stop's port to the rings, and of that from them; auto is the width of a ring.");
  v.field("fair_after_cycles", c.fair_after_cycles, IntRange{0, 1'000'000'000}, "cycles",
          "The wait after which a stop reserves the next slot, or gets the next grant of all; 0 is never, and then a "
          "stop may wait for ever.");
  v.field("grant_cycles", c.grant_cycles, IntRange{0, 1'000'000}, "cycles",
          "The time from a request of a stop, with grants, until the arbiter can have granted it.");
  v.field("command_cycles", c.command_cycles, IntRange{0, 1'000'000}, "cycles",
          "The time between two grants of all stops and rings, as a command bus admits them; 0 is no such bus.");
  v.field("start_cycles", c.start_cycles, IntRange{1, 1'000'000}, "cycles", "The time between two grants on one ring.");
  v.field_or_auto("transfers", c.transfers, IntRange{1, 65536}, "packets",
                  "The packets that stops may be putting onto one ring at a time, with grants; auto is any number.");
}

template <class V>
void describe(V& v, GraphLink& c) {
  v.field("from", c.from, "", "The node that it leaves, or several, such as r[*] or r[0..3].");
  v.field("to", c.to, "", "The node to which it leads. Of several on both sides, each goes with its fellow.");
  v.field("all_to", c.all_to, "", "Nodes to each of which all of `from` have a link, but for themselves.");
  v.field("ring", c.ring, "", "Nodes each of which has a link to the next, and the last to the first.");
  v.field("line", c.line, "", "Nodes each of which has a link to the next.");
  v.field("mesh", c.mesh, IntRange{1, kMaxResources}, "nodes",
          "Columns and rows of nodes with links in both directions to their neighbours.");
  v.field("of", c.of, "", "The nodes of a mesh, row by row; without it, all resources.");
  v.field("both", c.both, "", "Each link has a fellow in the other direction.");
  v.field_or_auto("latency_cycles", c.latency_cycles, kCycles, "cycles",
                  "The time that a packet takes over the link; auto is that of topology.link.")
      .relax("link_latency", Better::kHalf);
  v.field_or_auto("bytes_per_cycle", c.bytes_per_cycle, IntRange{1, 65536}, "bytes/cycle",
                  "The width of the link; auto is that of topology.link.")
      .relax("link_bandwidth", Better::kTwice);
  v.field_or_auto("depth", c.depth, IntRange{1, 65536}, "packets",
                  "The number of packets that the link, or each of its virtual channels, holds; auto is that of "
                  "topology.link.")
      .relax("packets_in_flight", Better::kTwice);
  v.choices("carries", c.carries,
            "What travels over the link: packets; shapes, which are requests to caches and memory with all that they "
            "read and write; rays from ray control and back to it. Messages of a kind that no link carries have wires "
            "of their own.");
  v.field_or_auto("virtual_channels", c.virtual_channels, kChannels, "channels",
                  "The queues that share the link; auto is those of topology.link.");
  v.field("dateline", c.dateline, "",
          "Under topology.channels: dateline, a packet that goes on by this link takes a channel of the next class. If "
          "no link says so, they are chosen so that they break every circle.");
  v.field_or_auto("lane", c.lane, IntRange{0, kMaxLanes - 1}, "",
                  "The packets that may take the link, those of a lane. A resource's packets have lanes in turn, and "
                  "keep them until they are home. Auto is packets of all lanes.");
  v.field("lanes", c.lanes, IntRange{1, kMaxLanes}, "links",
          "The number of equal links side by side, one for each lane from `lane` on, or from 0 on.");
  v.choice("queue", c.queue, "The queue that carries the link in the native engine; left out, that of topology.link.");
  v.field("clock", c.clock, "", "The clock of the link, a name of `clocks`; left out, noc.");
  v.section("stops", c.stops, "The stops of a ring.");
}

}  // namespace config
}  // namespace carousel
