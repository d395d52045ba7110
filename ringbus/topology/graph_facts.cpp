#include "ringbus/topology/graph_facts.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "core/config/graph/lane_rings.h"
#include "core/config/graph/ring.h"
#include "core/config/graph/way_time.h"
#include "core/system/error.h"
#include "ringbus/topology/graph/channel_classes.h"
#include "ringbus/topology/graph/dependencies.h"
#include "ringbus/topology/graph/routes.h"
#include "ringbus/topology/shapes.h"

namespace carousel::ringbus {

using config::Graph;

Graph draw_whole(const TopologyConfig& config) {
  std::vector<config::GraphIssue> issues;
  Graph graph = config::draw_graph(config, issues);
  if (issues.empty()) config::check_ways(graph, issues);
  if (!issues.empty()) throw SimulationError(fmt::format("{}: {}", issues.front().key, issues.front().message));
  return graph;
}

Graph draw_checked(const TopologyConfig& config) {
  return draw_whole(config).only(Carried::kPackets);
}

double link_mm(const Graph& graph, const Graph::Link& link) {
  const GraphPoint &from = graph.nodes[link.from].at, &to = graph.nodes[link.to].at;
  return std::abs(from.x - to.x) + std::abs(from.y - to.y);
}

std::string circle_text(const Graph& graph, const std::vector<std::uint32_t>& circle) {
  constexpr std::size_t kShown = 8;
  std::string out;
  for (std::size_t i = 0; i < circle.size() && i < kShown; ++i)
    out += (i == 0 ? "" : ", ") + graph.name_of(graph.links[circle[i]]);
  return circle.size() > kShown ? fmt::format("{} and {} more", out, circle.size() - kShown) : out;
}

namespace {

template <class Body>
void for_all_pairs(const Graph& graph, const Body& body) {
  for (std::uint32_t from = 0; from < graph.resources; ++from)
    for (std::uint32_t to = 0; to < graph.resources; ++to)
      if (graph.packets_go(from, to)) body(from, to);
}

/// "packet processes: a serves r[0], r[1]; b serves r[2], r[3]"
std::string served_text(const Graph& graph) {
  if (graph.manager_of.empty()) return "";
  constexpr std::size_t kShown = 8;
  std::string out = "packet processes: ";
  for (const std::uint32_t manager : graph.issuers()) {
    out += fmt::format("{}{} serves ", out.ends_with(": ") ? "" : "; ", graph.nodes[manager].name);
    std::size_t served = 0;
    for (std::uint32_t r = 0; r < graph.resources; ++r) {
      if (r == manager || graph.manager_of[r] != manager) continue;
      if (served++ < kShown) out += (served > 1 ? ", " : "") + graph.nodes[r].name;
    }
    if (served > kShown) out += fmt::format(" and {} more", served - kShown);
  }
  return out + "\n";
}

/// The links of a way.
std::size_t links_of(const Routes& routes, std::uint32_t from, std::uint32_t to) {
  std::size_t links = 0;
  routes.for_each_link(from, to, [&](std::uint32_t) { ++links; });
  return links;
}

/// The lanes whose ways a packet may take: all, or those with the fewest links.
std::vector<const Routes*> lanes_for(const std::vector<Routes>& lanes, bool shortest, std::uint32_t from,
                                     std::uint32_t to) {
  std::vector<const Routes*> out;
  std::size_t least = 0;
  for (const Routes& lane : lanes) {
    const std::size_t links = shortest ? links_of(lane, from, to) : 0;
    if (links < least) out.clear();
    if (out.empty() || links == least) {
      least = links;
      out.push_back(&lane);
    }
  }
  return out;
}

}  // namespace

GraphFacts graph_facts(const TopologyConfig& config, bool traffic) {
  const Graph graph = draw_checked(config);
  const bool shortest = traffic && config::keeps_lanes(config);
  GraphFacts facts;
  facts.resources = graph.resources;
  facts.routers = graph.of_kind(GraphNodeKind::kRouter).size();
  facts.links = graph.links.size();
  facts.served = served_text(graph);
  const auto bus = graph.bus();
  if (bus) facts.bus = graph.nodes[*bus].name;
  std::vector<Routes> lanes;
  for (std::size_t lane = 0; lane < graph.lanes; ++lane) lanes.emplace_back(graph, lane);
  std::vector<std::uint64_t> pairs(graph.links.size());
  std::vector<double> loads(graph.links.size());  // of a packet from each resource to each
  double packets = 0, nodes = 0, cycles = 0;
  const auto add_way = [&](const Routes& routes, std::uint32_t from, std::uint32_t to, double part) {
    config::WayTime time(graph);
    std::uint64_t links = 0;
    routes.for_each_link(from, to, [&](std::uint32_t link) {
      time.go(graph.links[link]);
      ++pairs[link];
      loads[link] += part;
      ++links;
    });
    const std::int64_t way = time.cycles();
    ++facts.ways;
    facts.diameter = std::max(facts.diameter, links);
    packets += part;
    nodes += part * static_cast<double>(links + 1);
    cycles += part * static_cast<double>(way);
    if (way <= facts.longest_cycles) return;
    facts.longest_cycles = way;
    facts.longest_from = graph.nodes[from].name;
    facts.longest_to = graph.nodes[to].name;
  };
  for_all_pairs(graph, [&](std::uint32_t from, std::uint32_t to) {
    const std::vector<const Routes*> some = lanes_for(lanes, shortest, from, to);
    for (const Routes* lane : some) add_way(*lane, from, to, shortest ? 1.0 / static_cast<double>(some.size()) : 1.0);
  });
  facts.mean_nodes = nodes / packets;
  facts.mean_cycles = cycles / packets;
  if (graph.links.empty()) return facts;
  facts.halves = narrowest_halves(graph);
  facts.halves_links = circle_text(graph, facts.halves.links);
  if (std::ranges::all_of(graph.nodes, [](const Graph::Node& node) { return node.at.given; })) {
    facts.wire_mm = 0;
    for (const Graph::Link& link : graph.links) {
      const double mm = link_mm(graph, link);
      *facts.wire_mm += mm;
      facts.wire_bit_mm += 8 * static_cast<double>(link.bytes_per_cycle) * mm;
    }
  }
  std::uint32_t busiest = 0;
  const auto per_core = [&](const Graph::Link& link) {  // its cycles in one of the resources
    return link.mhz == 0 ? 1.0 : static_cast<double>(link.mhz) / static_cast<double>(graph.core_mhz);
  };
  // Rings side by side share the ways between their stops.
  const auto load = [&](std::uint32_t link) {
    const std::int64_t rings = config.links[graph.links[link].entry].stops.rings;
    const auto bytes = static_cast<double>(graph.links[link].bytes_per_cycle * rings);
    return loads[link] / (bytes * per_core(graph.links[link]));
  };
  const auto ends = [&](std::uint32_t link) { return std::tuple(graph.links[link].from, graph.links[link].to); };
  for (std::uint32_t link = 1; link < graph.links.size(); ++link)
    if (load(link) > load(busiest) || (load(link) == load(busiest) && ends(link) < ends(busiest))) busiest = link;
  facts.busiest = graph.name_of(graph.links[busiest]);
  facts.busiest_pairs = pairs[busiest];
  double load_of_busiest = load(busiest);
  if (bus) {  // its links cross it one at a time
    facts.busiest = facts.bus;
    facts.busiest_pairs = static_cast<std::uint64_t>(graph.resources) * (graph.resources - 1);
    load_of_busiest = static_cast<double>(facts.busiest_pairs) / static_cast<double>(config.link.bytes_per_cycle);
  }
  if (facts.busiest_pairs > 0)
    facts.bound = packets / static_cast<double>(graph.resources) /
                  (load_of_busiest * static_cast<double>(config.link.bytes_per_cycle));
  return facts;
}

namespace {

std::string stops_text(const RingStops& stops, bool few) {
  const bool slots = stops.rule == RingStops::Rule::kSlots;
  std::string rule =
      slots ? "slots: nothing waits on the ring, and a flit that finds its port busy goes round again, until it is the "
              "oldest at the latest"
            : "grants: a packet starts when its whole way is free, the port at its end included, and nothing waits on "
              "the ring";
  if (few) rule += "; so does a packet that finds no place at a router, and the oldest of them gets the next";
  if (stops.fair_after_cycles == 0)
    rule += "; a stop may wait for as long as others keep its way full (fair_after_cycles: 0)";
  else
    rule += fmt::format("; no stop waits for ever, as after {} cycles it {}", stops.fair_after_cycles,
                        slots ? "marks a slot that no other stop may fill" : "gets the next grant of all");
  return rule;
}

}  // namespace

std::vector<bool> few_places(const Graph& graph) {
  std::vector<bool> out;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i)
    out.push_back(i >= graph.resources && graph.nodes[i].drawn->buffers.has_value());
  return out;
}

std::string stop_rings_text(const Graph& graph, const std::vector<config::StopRing>& rings) {
  const std::vector<bool> few = few_places(graph);
  std::vector<std::string> texts;  // those that differ
  for (const config::StopRing& ring : rings) {
    std::string text =
        stops_text(ring.drawn->stops, std::ranges::any_of(ring.nodes, [&](std::uint32_t stop) { return few[stop]; }));
    if (std::ranges::find(texts, text) == texts.end()) texts.push_back(std::move(text));
  }
  return fmt::format("{}", fmt::join(texts, "; "));
}

DeadlockVerdict traffic_verdict(const TopologyConfig& config) {
  if (config::keeps_lanes(config)) return plan_traffic(config).verdict;
  const Graph graph = draw_checked(config);
  const std::vector<config::StopRing> rings = config::stop_rings(config, graph);
  if (config::lone_stop_ring_entry(config)) return {false, stop_rings_text(graph, rings)};
  const Routes routes(graph);
  Dependencies waits = traffic_dependencies(graph, routes);
  join_stop_rings(waits, graph, rings, few_places(graph));
  const std::vector<std::uint32_t> circle = waits.smallest_circle(std::vector<std::uint64_t>(graph.links.size(), 1), 2);
  const std::string of_rings = rings.empty() ? "" : "; " + stop_rings_text(graph, rings);
  if (circle.empty())
    return {false, fmt::format("{}: the links of all ways can be put in an order in which every packet takes them, and "
                               "the sink takes every packet in{}",
                               config.routes == Routing::kUpDown ? "up_down" : "no circle", of_rings)};
  const std::string full = fmt::format("a circle of {} links wait for one another when they are full ({})",
                                       circle.size(), circle_text(graph, circle));
  if (!rings.empty())
    return {true,
            full + "; where packets get off a ring, routers with buffers: auto have room for all of them" + of_rings};
  const ChannelPlan plan = plan_channels(config, graph, routes);
  if (plan.rule == ChannelRule::kAny)
    return {true, full +
                      "; on a graph no rule keeps synthetic traffic from that, but virtual channels under "
                      "topology.channels: dateline would, and on rings topology.flow under topology.channels: none"};
  const ChannelDependencies channels = channel_dependencies(graph, routes, plan);
  const std::vector<std::uint32_t> left =
      channels.waits.smallest_circle(std::vector<std::uint64_t>(channels.link_of.size(), 1), 2);
  const std::string rule = plan.rule == ChannelRule::kHops ? "links passed" : fmt::format("datelines passed ({})", [&] {
    std::vector<std::uint32_t> lines;
    for (std::uint32_t link = 0; link < graph.links.size(); ++link)
      if (plan.datelines[link]) lines.push_back(link);
    return circle_text(graph, lines);
  }());
  if (left.empty())
    return {false, fmt::format("virtual channels: {}, but each packet is on a channel of the class of the {}, and of "
                               "the {} classes none waits for one before it",
                               full, rule, plan.classes)};
  std::uint32_t fewest = channels.link_of[left.front()];
  for (const std::uint32_t one : left)
    if (plan.channels[channels.link_of[one]] < plan.channels[fewest]) fewest = channels.link_of[one];
  if (plan.channels[fewest] >= plan.classes)
    return {true, fmt::format("{}, and no dateline breaks it: {}", full, [&] {
              std::vector<std::uint32_t> links;
              for (const std::uint32_t one : left) links.push_back(channels.link_of[one]);
              return circle_text(graph, links);
            }())};
  return {true, fmt::format("{}; the ways need channels of {} classes by {}, and {} has {}", full, plan.classes, rule,
                            graph.name_of(graph.links[fewest]), plan.channels[fewest])};
}

}  // namespace carousel::ringbus
