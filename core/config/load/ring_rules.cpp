#include <cstdint>
#include <set>
#include <string>
#include <string_view>
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

/// The keys of a node where packets wait.
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

/// A ring with stops is the whole network, and its stops have no queues.
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
  if (config.faults.links.any() && !has_traffic(config))
    breach("faults.links", fmt::format("a ring with rule: {} has no faults yet; expected none", rule));
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
  only(link.carries != plain.carries, "carries", "[packets]");
  if (c.links.size() > 1)
    return breach(fmt::format("topology.links.{}", entry == 0 ? 1 : 0),
                  fmt::format("a ring with rule: {} is the whole network; expected no other links", rule));
  std::set<std::uint32_t> stops;  // nodes that are missing have no link, which check_ways() says
  for (const Graph::Link& one : graph.links) stops.insert(one.from);
  for (std::size_t i = 0; i < c.nodes.size(); ++i) check_stop(c.nodes[i], fmt::format("topology.nodes.{}", i), breach);
  const std::size_t lanes = static_cast<std::size_t>(link.stops.rings) * (link.both ? 2 : 1);
  if (stops.size() < 3 || graph.links.size() != stops.size() * lanes)
    breach(key + ".ring", fmt::format("expected three nodes at least, each of them once, found {} nodes in {} steps",
                                      stops.size(), graph.links.size() / lanes));
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
  if (traffic.reply_bytes > 0 && !stop_ring_entry(config.topology))
    breach("workload.traffic.reply_bytes",
           fmt::format("answers are modelled on a ring with stops; expected 0, or stops: {{rule: slots}} at the ring "
                       "of a graph, found {}",
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
    if (node.mhz == 0 || traffic || node.kind == GraphNodeKind::kRouter) continue;
    breach(fmt::format("topology.nodes.{}.clock", i),
           fmt::format("a {} goes by the clock of the run, in whose cycles its parts are counted; expected core, or a "
                       "router, or workload: traffic; found {}",
                       enum_name(node.kind), node.clock));
  }
  for (const GraphLink& link : c.links) several |= link.mhz != 0;
  if (!several) return;
  for (std::size_t i = 0; i < c.links.size(); ++i)
    if (c.links[i].carries != GraphLink{}.carries)
      breach(fmt::format("topology.links.{}.carries", i),
             "a drawing that carries more than packets has one clock yet; expected [packets], or equal clocks");
  if (config.faults.links.any() && !traffic)
    breach("faults.links", "links between several clocks have no faults yet; expected none, or equal clocks");
  for (std::size_t i = 0; i < c.links.size() && is_bus(c); ++i)
    if (const GraphLink& link = c.links[i]; link.mhz != 0)
      breach(fmt::format("topology.links.{}.clock", i),
             fmt::format("a bus moves its packets one after the other by the clock of the resources; expected core, "
                         "found {}",
                         link.clock.empty() ? "noc" : link.clock));
  const auto ring = stop_ring_entry(c);
  if (!ring) return;
  for (std::size_t i = 0; i < c.nodes.size(); ++i)
    if (!c.nodes[i].clock.empty() && mhz_of(c.nodes[i].mhz) != mhz_of(c.links[*ring].mhz))
      breach(fmt::format("topology.nodes.{}.clock", i),
             fmt::format("a stop goes by the clock of its ring; expected one of {} MHz, or none; found {}",
                         mhz_of(c.links[*ring].mhz), c.nodes[i].clock));
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
    if (const auto entry = stop_ring_entry(c); entry && issues.empty()) check_stop_ring(config, graph, *entry, breach);
  }
  if (has_traffic(config)) check_traffic_ends(config, breach);
  check_clocks(config, breach);
}

}  // namespace carousel::config
