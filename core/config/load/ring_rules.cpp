#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/config/graph/clocks.h"
#include "core/config/graph/graph.h"
#include "core/config/graph/ring.h"
#include "core/config/load/network_rules.h"
#include "core/text/edit_distance.h"

namespace carousel::config {

namespace {

bool has_traffic(const Config& config) {
  return config.workload.kind == WorkloadConfig::Kind::kTraffic;
}

/// The keys of stops that the rule of the stops has.
void check_stops(const RingStops& stops, const std::string& key, const RuleBreach& breach) {
  const RingStops none;
  const auto only = [&](bool differs, std::string_view name, std::string_view rules) {
    if (differs)
      breach(fmt::format("{}.{}", key, name), fmt::format("stops with rule: {} do not have this key; expected rule: "
                                                          "{}, or none",
                                                          enum_name(stops.rule), rules));
  };
  const bool queues = stops.rule == RingStops::Rule::kQueues, grants = stops.rule == RingStops::Rule::kGrants;
  only(queues && stops.rings != none.rings, "rings", "slots or grants");
  only(queues && stops.port_bytes_per_cycle.has_value(), "port_bytes_per_cycle", "slots or grants");
  only(queues && stops.fair_after_cycles != none.fair_after_cycles, "fair_after_cycles", "slots or grants");
  only(!grants && stops.grant_cycles != none.grant_cycles, "grant_cycles", "grants");
  only(!grants && stops.command_cycles != none.command_cycles, "command_cycles", "grants");
  only(!grants && stops.start_cycles != none.start_cycles, "start_cycles", "grants");
  only(!grants && stops.transfers.has_value(), "transfers", "grants");
}

/// A node at which there is nothing but a ring has no keys of a node where packets wait.
void check_stop(const GraphNode& node, const std::string& key, const RuleBreach& breach) {
  const auto none = [&](std::string_view name, std::int64_t found) {
    if (found > 0)
      breach(fmt::format("{}.{}", key, name),
             fmt::format("nothing waits at a stop, whose time is that of the link behind it; expected none, found {}",
                         found));
  };
  none("latency_cycles", node.latency_cycles);
  none("credit_cycles", node.credit_cycles);
  none("claim_cycles", node.claim_cycles);
  none("buffers", node.buffers.value_or(0));
  if (node.forward != Forward::kHead)
    breach(key + ".forward", fmt::format("nothing waits at a stop; expected head, found {}", enum_name(node.forward)));
}

/// The places of a router between rings. Packets of all other stops may have got off in part, and hold places until the
/// rest of them has come, so there is one more at least, of a packet that goes on.
void check_bridge(const Graph::Node& node, const config::StopRing& ring, const RuleBreach& breach) {
  if (!node.drawn->buffers) return;
  const std::string key = fmt::format("topology.nodes.{}.buffers", node.entry);
  const auto stops = static_cast<std::int64_t>(ring.nodes.size());
  if (ring.drawn->stops.rule == RingStops::Rule::kGrants)
    breach(key, fmt::format("an arbiter knows no places of {}, and takes it that there are enough; expected auto, or "
                            "rule: slots, found {}",
                            node.name, *node.drawn->buffers));
  else if (*node.drawn->buffers < stops)
    breach(key, fmt::format("packets of all stops may have come to {} in part, each in a place of its own; expected "
                            "{} or more, as many as the ring has stops, or auto; found {}",
                            node.name, stops, *node.drawn->buffers));
}

/// The stops of a ring have no queues.
void check_stop_ring(const Config& config, const Graph& graph, std::size_t entry, const RuleBreach& breach) {
  const TopologyConfig& c = config.topology;
  const GraphLink& link = c.links[entry];
  const std::string key = fmt::format("topology.links.{}", entry);
  const std::string_view rule = enum_name(link.stops.rule);
  if (link.ring.empty())
    return breach(key + ".stops.rule", fmt::format("only a ring has such stops; expected queues, found {}", rule));
  if (config.engine.kind == EngineKind::kNative)
    breach(key + ".stops.rule",
           fmt::format("the native engine has no ring whose stops have no queues; expected queues, or engine.kind: "
                       "cycle; found {}",
                       rule));
  if (link.depth)
    breach(key + ".depth",
           fmt::format("a ring with rule: {} holds a flit for each cycle of its latency and has no queues; expected "
                       "auto, found {}",
                       rule, *link.depth));
  const GraphLink plain;
  const auto only = [&](bool differs, std::string_view name, std::string_view expected) {
    if (differs)
      breach(fmt::format("{}.{}", key, name),
             fmt::format("a ring with rule: {} has no queues and carries packets; expected {}", rule, expected));
  };
  only(link.virtual_channels.has_value(), "virtual_channels", "auto");
  only(link.dateline, "dateline", "false");
  only(link.carries != plain.carries, "carries", properties_of(c).has_packets ? "[packets]" : "stops: {rule: queues}");
  std::set<std::uint32_t> stops;  // nodes that are missing have no link, which check_ways() says
  std::size_t links = 0;
  for (const Graph::Link& one : graph.links) {
    if (one.entry != entry) continue;
    stops.insert(one.from);
    ++links;
  }
  const std::size_t lanes = static_cast<std::size_t>(link.stops.rings) * (link.both ? 2 : 1);
  if (stops.size() < 3 || links != stops.size() * lanes)
    breach(key + ".ring", fmt::format("expected three nodes at least, each of them once, found {} nodes in {} steps",
                                      stops.size(), links / lanes));
}

/// Rings with stops and what they meet.
void check_stop_rings(const Config& config, const Graph& graph, const RuleBreach& breach) {
  const TopologyConfig& c = config.topology;
  const auto first = stop_ring_entry(c);
  if (!first) return;
  if (config.faults.links.any() && !has_traffic(config))
    breach("faults.links",
           fmt::format("a ring with rule: {} has no faults yet; expected none", enum_name(c.links[*first].stops.rule)));
  for (std::size_t i = 0; i < c.links.size(); ++i) {
    if (has_stops(c.links[i])) check_stop_ring(config, graph, i, breach);
    if (c.links[i].lane || c.links[i].lanes > 1)
      breach(fmt::format("topology.links.{}.{}", i, c.links[i].lane ? "lane" : "lanes"),
             fmt::format("a drawing with a ring of stops has no lanes yet; expected {}, or rule: queues",
                         c.links[i].lane ? "auto" : "1"));
  }
  std::set<std::size_t> checked;  // nodes of the configuration
  const auto plain = plain_stops(c, graph);
  for (std::size_t i = 0; i < graph.nodes.size(); ++i)
    if (const std::size_t entry = graph.nodes[i].entry; plain[i] && checked.insert(entry).second)
      check_stop(c.nodes[entry], fmt::format("topology.nodes.{}", entry), breach);
  std::map<std::uint32_t, const StopRing*> bridges;  // by node: the ring that asks for most
  const std::vector<StopRing> rings = stop_rings(c, graph);
  const auto asks_more = [](const StopRing& one, const StopRing& other) {
    return std::pair(one.drawn->stops.rule, one.nodes.size()) > std::pair(other.drawn->stops.rule, other.nodes.size());
  };
  for (const StopRing& ring : rings)
    for (const std::uint32_t node : ring.nodes)
      if (node >= graph.resources && !plain[node])
        if (const StopRing*& most = bridges[node]; most == nullptr || asks_more(ring, *most)) most = &ring;
  for (const auto& [node, ring] : bridges) check_bridge(graph.nodes[node], *ring, breach);
  if (lone_stop_ring_entry(c) || !has_traffic(config)) return;
  if (c.channels != ChannelRule::kAny)
    breach("topology.channels",
           fmt::format("a ring with stops has no virtual channels; expected any, found {}", enum_name(c.channels)));
  for (std::size_t i = 0; i < c.links.size(); ++i)
    if (!has_stops(c.links[i]) && c.links[i].virtual_channels.value_or(c.link.virtual_channels) > 1)
      return breach(c.links[i].virtual_channels ? fmt::format("topology.links.{}.virtual_channels", i)
                                                : "topology.link.virtual_channels",
                    "a drawing with a ring of stops has one channel a link yet; expected 1");
}

void check_traffic_ends(const Config& config, const RuleBreach& breach) {
  const TrafficConfig& traffic = config.workload.traffic;
  const bool graph = config.topology.shape == TopologyShape::kGraph;
  const auto check = [&](const char* key, const std::string& pattern) {
    if (pattern.empty()) return;
    if (!graph)
      return breach(key, fmt::format("only the nodes of a graph have names; expected none, or topology.shape: graph; "
                                     "found {}",
                                     pattern));
    std::string error;
    if (named_resources(config.topology, pattern, error).empty()) breach(key, std::move(error));
  };
  check("workload.traffic.sources", traffic.sources);
  check("workload.traffic.destinations", traffic.destinations);
  if (traffic.pattern == TrafficConfig::Pattern::kExchange && config.topology.resources % 2 != 0)
    breach("workload.traffic.pattern",
           fmt::format("exchange pairs the resources; expected an even number of them, or another pattern, found {}",
                       config.topology.resources));
  if (traffic.reply_bytes > 0 && !lone_stop_ring_entry(config.topology))
    breach("workload.traffic.reply_bytes",
           fmt::format("answers are modelled on a ring with stops that is alone; expected 0, or stops: {{rule: slots}} "
                       "at the only link of a graph, found {}",
                       traffic.reply_bytes));
}

/// Each clock that is named is there, and each that is there is named.
void check_clock_names(const Config& config, const RuleBreach& breach) {
  const ClockTable clocks{config.clocks, config.engine.clock_mhz};
  const std::vector<std::string> names = clocks.names();
  std::set<std::string> used;
  const auto look = [&](const std::string& name, const char* list, std::size_t i) {
    if (name.empty()) return;
    used.insert(name);
    if (name == "noc" && !config.clocks.noc)
      return breach(fmt::format("topology.{}.{}.clock", list, i),
                    "there is no clocks.noc; expected it besides, or clock: core; found noc");
    if (clocks.of(name)) return;
    const auto near = nearest_name(name, names);
    breach(fmt::format("topology.{}.{}.clock", list, i),
           fmt::format("expected a clock, one of {}; found '{}'{}", fmt::join(names, ", "), name,
                       near ? fmt::format("; did you mean '{}'?", *near) : ""));
  };
  for (std::size_t i = 0; i < config.topology.nodes.size(); ++i) look(config.topology.nodes[i].clock, "nodes", i);
  for (std::size_t i = 0; i < config.topology.links.size(); ++i) look(config.topology.links[i].clock, "links", i);
  const std::vector<std::string> keys{"core", "noc", "synchroniser_cycles"};
  for (const auto& [name, mhz] : config.clocks.others) {
    if (used.contains(name)) continue;
    const auto near = nearest_name(name, keys);
    breach("clocks." + name, fmt::format("no node or link goes by this clock; expected clock: {} at one of them{}",
                                         name, near ? fmt::format("; did you mean '{}'?", *near) : ""));
  }
}

/// Refuses clocks at parts that cannot have one of their own yet.
void check_clocked_parts(const Config& config, const RuleBreach& breach) {
  const TopologyConfig& c = config.topology;
  const bool traffic = has_traffic(config);
  const auto mhz_of = [&](std::int64_t mhz) { return mhz == 0 ? config.engine.clock_mhz : mhz; };
  bool several = false;
  for (std::size_t i = 0; i < c.nodes.size(); ++i) {
    const GraphNode& node = c.nodes[i];
    several |= node.mhz != 0;
    if (node.mhz == 0 || traffic || node.kind == GraphNodeKind::kRouter || node.kind == GraphNodeKind::kMemory)
      continue;
    breach(fmt::format("topology.nodes.{}.clock", i),
           fmt::format("a {} goes by the clock of the run, in whose cycles its parts are counted; expected core, or a "
                       "router or memory, or workload: traffic; found {}",
                       enum_name(node.kind), node.clock));
  }
  for (const GraphLink& link : c.links) several |= link.mhz != 0;
  if (!several) return;
  for (std::size_t i = 0; i < c.links.size() && is_bus(c); ++i)
    if (const GraphLink& link = c.links[i]; link.mhz != 0)
      breach(fmt::format("topology.links.{}.clock", i),
             fmt::format("a bus moves its packets one after the other by the clock of the resources; expected core, "
                         "found {}",
                         link.clock.empty() ? "noc" : link.clock));
  if (!stop_ring_entry(c)) return;
  std::vector<GraphIssue> issues;  // check_rings() tells
  const Graph graph = draw_graph(c, issues);
  const auto plain = plain_stops(c, graph);
  std::set<std::size_t> checked;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    const std::size_t entry = graph.nodes[i].entry;
    const GraphNode& node = c.nodes[entry];
    if (!plain[i] || node.clock.empty() || mhz_of(node.mhz) == mhz_of(c.links[*plain[i]].mhz)) continue;
    if (checked.insert(entry).second)
      breach(fmt::format("topology.nodes.{}.clock", entry),
             fmt::format("a stop goes by the clock of its ring; expected one of {} MHz, or none; found {}",
                         mhz_of(c.links[*plain[i]].mhz), node.clock));
  }
}

void check_clocks(const Config& config, const RuleBreach& breach) {
  const std::int64_t core = config.engine.clock_mhz;
  if (config.clocks.core && *config.clocks.core != core)
    breach("clocks.core", fmt::format("the clock of the resources is engine.clock_mhz; expected {}, or one of the two "
                                      "keys, found {}",
                                      core, *config.clocks.core));
  const TopologyConfig& c = config.topology;
  if (c.shape != TopologyShape::kGraph) {
    const std::int64_t noc = config.clocks.noc.value_or(core);
    if (noc != core)
      breach("clocks.noc", fmt::format("only a graph has a clock of its own; expected {}, or topology.shape: graph, as "
                                       "check --graph writes it; found {}",
                                       core, noc));
    for (const auto& [name, mhz] : config.clocks.others)
      breach("clocks." + name,
             "only nodes and links of a graph go by clocks of other names; expected core, noc or "
             "synchroniser_cycles, or topology.shape: graph");
    return;
  }
  check_clock_names(config, breach);
  check_clocked_parts(config, breach);
}

}  // namespace

void check_rings(const Config& config, const RuleBreach& breach) {
  const TopologyConfig& c = config.topology;
  if (c.shape == TopologyShape::kGraph) {
    for (std::size_t i = 0; i < c.links.size(); ++i)
      check_stops(c.links[i].stops, fmt::format("topology.links.{}.stops", i), breach);
    std::vector<GraphIssue> issues;
    const Graph graph = draw_graph(c, issues);
    if (issues.empty()) check_stop_rings(config, graph, breach);
  }
  if (has_traffic(config)) check_traffic_ends(config, breach);
  check_clocks(config, breach);
}

}  // namespace carousel::config
