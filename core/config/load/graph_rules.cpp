#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/config/graph/drawn_parts.h"
#include "core/config/graph/graph.h"
#include "core/config/graph/lane_rings.h"
#include "core/config/load/network_rules.h"

namespace carousel::config {

namespace {

/// Links have lengths where both of their nodes have places, so a place that was forgotten would go unnoticed.
void check_places(const std::vector<GraphNode>& nodes, const RuleBreach& breach) {
  const auto given = [](const GraphNode& node) { return node.at.given; };
  if (std::ranges::none_of(nodes, given)) return;
  const auto without = std::ranges::find_if_not(nodes, given);
  if (without != nodes.end())
    breach(
        fmt::format("topology.nodes.{}", without - nodes.begin()),
        fmt::format("other nodes have places, and {} has none; expected `at` at all nodes, or at none", without->name));
}

/// The keys of a node that its kind has.
void check_node(const GraphNode& node, const std::string& key, const RuleBreach& breach) {
  const bool bus = node.kind == GraphNodeKind::kBus;
  if (bus || takes_packets(node.kind)) {
    const std::string_view otherwise = bus ? "packets wait for a bus at the resources, and other nodes have this key"
                                           : "a resource has places for its packets in test, and other nodes this key";
    if (node.buffers) breach(key + ".buffers", fmt::format("{}; expected auto, found {}", otherwise, *node.buffers));
    if (node.forward != Forward::kHead)
      breach(key + ".forward", fmt::format("{}; expected head, found {}", otherwise, enum_name(node.forward)));
  }
  if (bus && node.count.value_or(1) > 1)
    breach(key + ".count", fmt::format("all packets cross the same bus; expected one, found {}", *node.count));
  const bool shading = node.kind == GraphNodeKind::kShading;
  if (!node.serves.empty() && node.kind != GraphNodeKind::kCache && node.kind != GraphNodeKind::kPacketProcess &&
      !shading)
    breach(key + ".serves", fmt::format("resources ask caches, packet processes collect their rays, and pools of "
                                        "workers shade them; expected none at a {}, found '{}'",
                                        enum_name(node.kind), node.serves));
  if (node.workers && !shading)
    breach(key + ".workers", fmt::format("only a node of the kind shading has workers; expected none at a {}, found {}",
                                         enum_name(node.kind), *node.workers));
  if (node.interleave_bytes && node.kind != GraphNodeKind::kCache && node.kind != GraphNodeKind::kMemory)
    breach(key + ".interleave_bytes", fmt::format("caches and memories hold lines; expected auto at a {}, found {}",
                                                  enum_name(node.kind), *node.interleave_bytes));
  if (node.kind != GraphNodeKind::kResource) {
    constexpr std::string_view only = "only a resource has this key; expected none at a";
    if (node.testers) breach(key + ".testers", fmt::format("{} {}", only, enum_name(node.kind)));
    for_each_own_key([&](const auto& row) {
      if (const auto own = node.own.*row.own)
        breach(fmt::format("{}.{}", key, row.name), fmt::format("{} {}, found {}", only, enum_name(node.kind), *own));
    });
  }
  if (node.claim_cycles > node.latency_cycles)
    breach(key + ".claim_cycles", fmt::format("expected at most latency_cycles, {}, of which it is a part; found {}",
                                              node.latency_cycles, node.claim_cycles));
  if ((node.step.given || node.columns) && !(node.at.given && node.count))
    breach(key + (node.step.given ? ".step" : ".columns"),
           "only the nodes of a group with a place stand side by side; expected count and at besides");
  else if (node.at.given && node.count.value_or(1) > 1 && !node.step.given)
    breach(key + ".at", "the nodes of a group cannot all stand there; expected step besides");
}

/// Refuses own keys of a node without that part: a packet process that serves has collections, resources all else.
void check_own_of(const Config& config, const OwnOf& one, const RuleBreach& breach) {
  const TopologyConfig& c = config.topology;
  bool is_process = false;
  for (std::int64_t r = ray_owners(c); r < c.resources; ++r) is_process |= one.is_about(r);
  const std::string place = own_place(one);
  if (is_process && one.testers != nullptr && *one.testers != config.testers)
    breach(place + ".testers", "a packet_process that serves resources has no testers");
  for_each_own_key([&](const auto& row) {
    if (!(one.keys->*row.own)) return;
    const std::string_view path = row.path;
    const std::string key = fmt::format("{}.{}", place, row.name);
    const bool collects = path.starts_with("collections.");
    if (is_process && !collects && !path.starts_with("packets."))
      breach(key,
             fmt::format("a packet_process that serves resources has collections alone; expected no {}", row.name));
    else if (!is_process && (collects || path == "memory.fetch_ahead"))
      breach(key, fmt::format("a packet_process collects the rays of these resources, and issues their packets; "
                              "expected no {}{}",
                              row.name, collects ? ", or `nodes` that name the packet_process" : ""));
  });
}

/// A packet process that serves resources has no testers that could be slow, and nobody takes over its resources: their
/// rays go to those of another.
void check_faulty_manager(const Config& config, const RuleBreach& breach) {
  const FaultsConfig::Resource& fault = config.faults.resource;
  using Kind = FaultsConfig::Resource::Kind;
  const bool is_process = fault.number >= ray_owners(config.topology) && fault.number < config.topology.resources;
  if (fault.kind == Kind::kNone) return;
  const auto refuse = [&](std::string_view key, std::string_view why, std::string_view expected) {
    breach(std::string(key), fmt::format("{}; expected {}, found {}", why, expected, fault.number));
  };
  constexpr std::string_view number = "faults.resource.number";
  const std::string resources = fmt::format("a resource from 0 to {}", ray_owners(config.topology) - 1);
  if (is_process && fault.kind == Kind::kSlow)
    refuse(number, "a packet_process that serves resources has no testers that could be slow", resources);
  else if (is_process && fault.kind == Kind::kStop && managers_of(config.topology) == 1)
    refuse(number, "when a packet_process stops, another one has to continue, and there is no other", resources);
  else if (!is_process && fault.kind == Kind::kStop && ray_owners(config.topology) == 1)
    refuse(number, "when a resource stops, another that owns rays has to continue", "two resources at least");
}

/// Packet processes that serve resources hold collections alone: they have no rays, testers and shapes, and the
/// resources have no collections.
void check_managers(const Config& config, const RuleBreach& breach) {
  const TopologyConfig& c = config.topology;
  const bool cycle = config.engine.kind == EngineKind::kCycle;
  const auto refuse = [&](bool wrong, std::string_view key, std::string_view message) {
    if (wrong) breach(std::string(key), std::string(message));
  };
  const auto value = [&](bool wrong, std::string_view key, std::string_view why, std::string_view expected,
                         std::string_view found) {
    if (wrong) breach(std::string(key), fmt::format("{}; expected {}, found {}", why, expected, found));
  };
  const auto kind_of = [&](GraphNodeKind kind) {
    return std::ranges::any_of(c.nodes, [&](const GraphNode& node) { return node.kind == kind; });
  };
  refuse(
      is_central(c), "topology.nodes",
      "each packet_process serves resources, or each has its own cells; expected `serves` at all of them, or at none");
  refuse(kind_of(GraphNodeKind::kBus), "topology.nodes",
         "a packet_process that serves resources is not on a bus yet; expected routers or direct links");
  refuse(
      cycle && !kind_of(GraphNodeKind::kCache), "topology.nodes",
      "the resources that a packet_process serves read their shapes from memories that are drawn; expected a node of "
      "the kind cache");
  refuse(config.workload.kind == WorkloadConfig::Kind::kTraffic, "topology.nodes",
         "synthetic traffic has no collections; expected no packet_process");
  value(c.visit != Visit::kOwners, "topology.visit", "a packet visits resources of its packet_process alone", "owners",
        enum_name(c.visit));
  value(config.collections.home != Home::kIssuer, "collections.home",
        "the packet_process keeps the collections of its resources", "issuer", enum_name(config.collections.home));
  const Placement placement = config.rays.placement;
  value(placement != Placement::kBalanced && placement != Placement::kRoundRobin, "rays.placement",
        "new rays go to the resources of one packet_process", "balanced or round_robin", enum_name(placement));
  value(config.packets.carry == PacketCarry::kData, "packets.carry",
        "a packet_process reads no shapes: the resources do, each from its memory", "reference", "data");
  refuse(config.shading.idle_resources_shade, "shading.idle_resources_shade",
         "a packet_process is no resource that shades; expected false, found true");
  check_faulty_manager(config, breach);
  for_each_own(c, [&](const OwnOf& one) { check_own_of(config, one, breach); });
}

/// A packet process spills to the cache that serves it, and asks it for nothing else.
void check_spilling(const Config& config, const Graph& graph, const DrawnParts& parts, const RuleBreach& breach) {
  if (graph.manager_of.empty() || config.engine.kind != EngineKind::kCycle) return;
  const bool spill = config.collections.when_full == WhenFull::kSpill;
  for (const std::uint32_t process : graph.issuers()) {
    const bool served = std::ranges::count(parts.spilling, process) > 0;
    if (served == spill) continue;
    return breach("collections.when_full",
                  spill
                      ? fmt::format("{0} has no memory to spill to; expected reserve, or a cache that serves {0}",
                                    graph.nodes[process].name)
                      : fmt::format("a cache serves {0}, which reads no shapes and spills nothing; expected spill, or "
                                    "no {0} in serves of the cache",
                                    graph.nodes[process].name));
  }
  if (spill && config.memory.l1_kib > 0)
    breach("memory.l1_kib", fmt::format("a packet_process has no L1 through which collections could spill; expected 0, "
                                        "or collections.when_full: reserve; found {}",
                                        config.memory.l1_kib));
}

/// Units of a central machine are all alike, and a distributor knows one.
void check_packet_processes(const Config& config, const RuleBreach& breach) {
  const std::vector<GraphNode>& nodes = config.topology.nodes;
  if (managers_of(config.topology) > 0) return check_managers(config, breach);
  if (!is_central(config.topology)) return;
  const auto other =
      std::ranges::find_if(nodes, [](const GraphNode& node) { return node.kind == GraphNodeKind::kResource; });
  if (other != nodes.end())
    breach(fmt::format("topology.nodes.{}.kind", other - nodes.begin()),
           "beside a packet_process with cells of its own all nodes that own rays are such units; expected "
           "packet_process, or `serves` at the packet_process; found resource");
  if (has_distributor(config) && drawn_resources(config.topology) > 1)
    breach("topology.form", fmt::format("a distributor stands in a machine of one unit yet; expected cells, or one "
                                        "packet_process; found distributor and {}",
                                        drawn_resources(config.topology)));
}

/// Lanes are of packets of rays.
void check_lanes(const Config& config, const RuleBreach& breach) {
  const TopologyConfig& c = config.topology;
  for (std::size_t i = 0; i < c.links.size(); ++i) {
    const GraphLink& link = c.links[i];
    if (!link.lane && link.lanes == 1) continue;
    const std::string key = fmt::format("topology.links.{}.{}", i, link.lane ? "lane" : "lanes");
    const std::string_view expected = link.lane ? "auto" : "1";
    if (config.workload.kind == WorkloadConfig::Kind::kTraffic && c.channels != ChannelRule::kNone)
      breach(key, fmt::format("synthetic packets have virtual channels and no lanes, or lanes and no channels; "
                              "expected {}, or topology.channels: none",
                              expected));
    if (link.carries != GraphLink().carries)
      breach(key,
             fmt::format("packets have lanes, and other messages none; expected {}, or carries: [packets]", expected));
  }
}

/// A bus moves its packets at one width.
void check_bus(const Config& config, const Graph& graph, const RuleBreach& breach) {
  if (!graph.bus()) return;
  if (config.workload.kind == WorkloadConfig::Kind::kTraffic)
    breach("topology.nodes", fmt::format("there is no traffic on a bus; expected routers in place of {}",
                                         graph.nodes[*graph.bus()].name));
  const auto other = std::ranges::find_if(graph.links, [&](const Graph::Link& link) {
    return link.carries_any({Carried::kPackets}) && link.bytes_per_cycle != config.topology.link.bytes_per_cycle;
  });
  if (other != graph.links.end())
    breach(fmt::format("topology.links.{}.bytes_per_cycle", other->entry),
           fmt::format("a bus is as wide for all, as topology.link says; expected {}, found {}",
                       config.topology.link.bytes_per_cycle, other->bytes_per_cycle));
}

/// Refuses what the wires of drawn parts cannot carry yet.
void check_parts(const Config& config, const Graph& graph, const DrawnParts& parts, const RuleBreach& breach) {
  const bool traffic = config.workload.kind == WorkloadConfig::Kind::kTraffic;
  bool shared = false;
  std::vector<char> named(config.topology.links.size());
  for (const Graph::Link& link : graph.links) {
    if (std::exchange(named[link.entry], 1) != 0) continue;
    const std::string key = fmt::format("topology.links.{}", link.entry);
    const bool packets = link.carries_any({Carried::kPackets}),
               others = link.carries_any({Carried::kShapes, Carried::kNewRays, Carried::kCompletedRays});
    if (!packets && !others) breach(key + ".carries", "a link carries something; expected [packets] for example");
    if (!packets && config.topology.links[link.entry].depth)
      breach(key + ".depth", fmt::format("a link without packets has room for all there is to carry, so nothing waits "
                                         "in a circle; expected no depth, found {}",
                                         link.depth));
    shared |= packets && others;
    if (packets && others && link.latency_cycles < 2)
      breach(key + ".latency_cycles",
             fmt::format("packets and others that share {} take turns at its near end, a cycle away; expected at least "
                         "2, found {}",
                         graph.name_of(link), link.latency_cycles));
  }
  if (shared && config.faults.links.any() && !traffic)
    breach("faults.links", "links that packets share with others have no faults yet; expected none");
  if (parts.caches.empty()) return;
  const auto refuse = [&](const char* key, bool found, std::string_view expected) {
    if (found) breach(key, fmt::format("caches that are drawn do not have this yet; expected {}", expected));
  };
  const MemoryConfig& memory = config.memory;
  using Free = MemoryConfig::ShadingData;
  refuse("memory.fetch", memory.fetch == MemoryConfig::Fetch::kMulticast, "resource, found multicast");
  refuse("memory.l2_ray_ways", memory.l2_ray_ways > 0, "0");
  refuse("memory.ray_records", memory.ray_records != MemoryConfig::RayRecords::kResource, "resource, found master");
  refuse("memory.path_state", memory.path_state != Free::kFree, "free, found memory");
  refuse("memory.film", memory.film != Free::kFree, "free, found memory");
  refuse("memory.sky_map", memory.sky_map != Free::kFree && config.scene.sky && !config.scene.sky->file.empty(),
         "free, found memory");
  refuse("raster.time", config.primary == Primary::kRaster && config.raster.time != RasterConfig::Time::kFree,
         "free, found cycles");
  refuse("memory.surfaces", memory.surfaces != Free::kFree, "free, found memory");
  Parts::for_each([&]<class P>(std::size_t) {
    if (P::is_built(config.parts.of<P>()))
      breach(fmt::format("{}.{}", P::kSection, P::kSwitch),
             "caches that are drawn have no such part yet; expected none");
  });
  const bool banks = std::ranges::any_of(parts.caches, [](const Banks& group) { return group.nodes.size() > 1; });
  if (banks && parts.memories.nodes.empty())
    breach("topology.nodes",
           "caches that hold lines in turn name them as they do; expected a node of the kind memory "
           "behind them, or one node a group of caches");
  refuse("memory.strip_end", banks && memory.strip_end == MemoryConfig::StripEnd::kFlag,
         "length, or one node a group of caches, as the walk along a strip does not go from node to node; found flag");
}

}  // namespace

void check_graph(const Config& config, const RuleBreach& breach) {
  const TopologyConfig& c = config.topology;
  if (c.shape != TopologyShape::kGraph) return;
  for (std::size_t i = 0; i < c.nodes.size(); ++i) check_node(c.nodes[i], fmt::format("topology.nodes.{}", i), breach);
  check_places(c.nodes, breach);
  check_packet_processes(config, breach);
  check_pools(config, breach);
  check_lanes(config, breach);
  for (std::size_t i = 0; i < c.nodes.size() && config.engine.kind == EngineKind::kNative; ++i)
    if (const GraphNodeKind kind = c.nodes[i].kind; kind != GraphNodeKind::kResource &&
                                                    kind != GraphNodeKind::kRouter && kind != GraphNodeKind::kShading &&
                                                    !is_manager(c.nodes[i]))
      breach(
          fmt::format("topology.nodes.{}.kind", i),
          fmt::format("the native engine draws resources, routers, shading and packet processes that serve resources; "
                      "expected these, or engine.kind: cycle; found {}",
                      enum_name(kind)));
  const std::int64_t resources = drawn_resources(c);
  if (resources == 0) return breach("topology.nodes", "expected a resource at least, such as {name: r, count: 8}");
  if (resources <= kMaxResources && resources != c.resources)
    breach("topology.resources",
           fmt::format("the graph has {0} resources; expected {0}, or no number, found {1}", resources, c.resources));
  if (config.area.budget_mm2 && config.area.fit != AreaConfig::Fit::kRefuse)
    breach("area.fit", fmt::format("a graph has as many resources as are drawn, which no budget changes; expected "
                                   "refuse, or no area.budget_mm2; found {}",
                                   enum_name(config.area.fit)));
  for (std::size_t i = 0; i < c.links.size() && config.engine.kind == EngineKind::kCycle; ++i)
    if (c.links[i].queue)
      breach(fmt::format("topology.links.{}.queue", i),
             fmt::format("the cycle engine has no real queues; expected none, or engine.kind: native; found {}",
                         enum_name(*c.links[i].queue)));
  std::vector<GraphIssue> issues;
  const Graph graph = draw_graph(c, issues);
  DrawnParts drawn;
  if (issues.empty()) check_ways(graph, issues);
  if (issues.empty()) drawn = find_parts(c, graph, config.memory.line_bytes, issues);
  if (issues.empty()) {
    check_parts(config, graph, drawn, breach);
    check_spilling(config, graph, drawn, breach);
    if (config.workload.kind == WorkloadConfig::Kind::kTraffic && keeps_lanes(c))
      lane_rings(c, graph.only(Carried::kPackets), issues);
    check_bus(config, graph, breach);
  }
  for (std::size_t i = 0; i < c.overrides.size(); ++i) {
    const ResourceOverride& one = c.overrides[i];
    if (one.nodes.empty()) continue;
    std::string error;
    const std::vector<std::uint32_t> found = graph.names.find(one.nodes, error);
    if (found.empty())
      issues.push_back({fmt::format("topology.overrides.{}.nodes", i), std::move(error)});
    else if (found.size() != one.named.size())
      issues.push_back({fmt::format("topology.overrides.{}.nodes", i),
                        fmt::format("only resources have testers; expected such nodes, found '{}'", one.nodes)});
  }
  const auto narrow = std::ranges::find_if(graph.links, [&](const Graph::Link& link) {
    return link.carries_any({Carried::kPackets}) && link.bytes_per_cycle != c.link.bytes_per_cycle;
  });
  const bool parts =
      config.packets.results == PacketResults::kPerShape || config.packets.results == PacketResults::kMessage;
  if (parts && narrow != graph.links.end() && config.workload.kind != WorkloadConfig::Kind::kTraffic)
    breach("packets.results",
           fmt::format("each result begins a cycle of its own, which is counted for links as wide as topology.link; "
                       "{} is {} bytes wide; expected mask or implied_order, found {}",
                       graph.name_of(*narrow), narrow->bytes_per_cycle, enum_name(config.packets.results)));
  const auto shallow = std::ranges::find_if(
      graph.links, [](const Graph::Link& link) { return link.carries_any({Carried::kPackets}) && link.depth < 2; });
  if (c.flow == Flow::kBubble && shallow != graph.links.end() && c.link.depth >= 2)
    breach(fmt::format("topology.links.{}.depth", shallow->entry),
           fmt::format("flow: bubble keeps one place of a link free; expected at least 2 for {}, found {}",
                       graph.name_of(*shallow), shallow->depth));
  if (config.workload.kind != WorkloadConfig::Kind::kTraffic)
    for (std::size_t i = 0; i < c.links.size(); ++i)
      if (c.links[i].virtual_channels || c.links[i].dateline)
        breach(fmt::format("topology.links.{}.{}", i, c.links[i].dateline ? "dateline" : "virtual_channels"),
               "virtual channels carry synthetic traffic, and packets of rays have one channel; expected none");
  if (c.channels != ChannelRule::kDateline)
    for (std::size_t i = 0; i < c.links.size(); ++i)
      if (c.links[i].dateline)
        breach(fmt::format("topology.links.{}.dateline", i),
               fmt::format("datelines change the channel under topology.channels: dateline, found {}",
                           enum_name(c.channels)));
  for (GraphIssue& issue : issues) breach(issue.key, std::move(issue.message));
}

}  // namespace carousel::config
