#include "core/config/graph/graph.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "core/config/graph/ring.h"
#include "ringbus/topology/graph/channel_classes.h"
#include "ringbus/topology/graph/dependencies.h"
#include "ringbus/topology/graph/routes.h"
#include "ringbus/topology/graph_facts.h"
#include "ringbus/topology/graph_wires.h"
#include "ringbus/topology/rounds.h"
#include "ringbus/topology/shapes.h"

namespace carousel::ringbus {

namespace {

using config::Graph;

/// The ways of each lane's packets.
std::vector<Routes> routes_of(const Graph& graph) {
  std::vector<Routes> out;
  for (std::size_t lane = 0; lane < graph.lanes; ++lane) out.emplace_back(graph, lane);
  return out;
}

/// A round from the first resource to the nearest that is left, and so on, by the cycles of the way; of equally near
/// ones, the first.
std::vector<ResourceId> nearest_round(const Graph& graph, const Routes& routes) {
  std::vector<ResourceId> round(graph.resources);
  std::vector<bool> left(graph.resources, true);
  std::uint32_t at = 0;
  for (std::uint32_t i = 1; i < graph.resources; ++i) {
    left[at] = false;
    constexpr std::int64_t kFar = std::numeric_limits<std::int64_t>::max();
    std::pair best{kFar, graph.resources};
    for (std::uint32_t to = 0; to < graph.resources; ++to) {
      if (!left[to]) continue;
      if (!graph.packets_go(at, to)) {  // the round leads there all the same, and no packet
        best = std::min(best, std::pair{kFar, to});
        continue;
      }
      std::int64_t cycles = 0;
      routes.for_each_link(at, to, [&](std::uint32_t link) {
        cycles += graph.links[link].latency_cycles + graph.nodes[graph.links[link].from].drawn->latency_cycles;
      });
      best = std::min(best, std::pair{cycles, to});
    }
    round[at] = ResourceId(best.second);
    at = best.second;
  }
  round[at] = ResourceId(0);
  return round;
}

/// Links between two resources, there and back, that hold no more than `enough` packets: the smallest circles there
/// are.
std::vector<std::uint32_t> there_and_back(const Graph& graph, const Routes& routes,
                                          const std::vector<config::StopRing>& rings,
                                          const std::vector<std::uint64_t>& places, std::uint64_t enough) {
  const auto rides = [&](std::uint32_t link) {  // where nothing waits for the link behind it
    return std::ranges::any_of(rings, [&](const config::StopRing& ring) { return ring.owns(link); });
  };
  for (std::uint32_t i = 0; i < graph.links.size(); ++i) {
    const Graph::Link& link = graph.links[i];
    if (link.from >= graph.resources || link.to >= graph.resources || rides(i)) continue;
    if (!graph.packets_go(link.from, link.to) || routes.link(link.from, link.to) != i) continue;
    const std::uint32_t back = routes.link(link.to, link.from);
    if (back != Routes::kNone && !rides(back) && graph.links[back].to == link.from &&
        places[i] + places[back] <= enough)
      return {i, back};
  }
  return {};
}

/// The most places that a router can be given.
constexpr std::int64_t kMaxPlaces = 65536;

/// Judges packets that visit resources: by the circles of links that wait for one another, and what these hold. Lanes
/// that have no links in common do not wait for one another, so a circle is in one of them.
class VisitJudge {
 public:
  VisitJudge(const TopologyConfig& config, const Graph& graph, const std::vector<config::StopRing>& rings,
             const std::vector<Routes>& routes, TopologyPlan& plan)
      : config_(config),
        graph_(graph),
        rings_(rings),
        routes_(routes),
        plan_(plan),
        each_(plan.packets_in_flight * (graph.lanes_meet() ? graph.lanes : 1)),
        issuers_(graph.issuers().size()),
        on_the_way_(each_ * issuers_) {
    for (const Graph::Link& link : graph.links) places_.push_back(static_cast<std::uint64_t>(link.depth) + 1);
    // A ring that is stuck is full, and so are the wire to it, the queue of a router where packets get off, and the
    // wire from there.
    for (const config::StopRing& ring : rings) {
      std::int64_t least = config.link.depth + kMaxPlaces;
      for (const std::uint32_t stop : ring.nodes)
        least = std::min(least, graph.nodes[stop].drawn->buffers.value_or(least));
      for (std::size_t i = ring.first; i < ring.first + ring.links(); ++i)
        places_[i] = 2 * static_cast<std::uint64_t>(config.link.depth) + 2 + static_cast<std::uint64_t>(least);
    }
  }

  /// Fills in the verdict, and whether resources need room for all packets.
  void judge() {
    std::vector<std::uint32_t> circle;
    for (std::size_t lane = 0; lane < graph_.lanes && circle.empty() && config_.visit == Visit::kOwners; ++lane)
      circle = there_and_back(graph_, routes_[lane], rings_, places_, on_the_way_);
    if (circle.empty()) circle = smallest(true);
    if (keeps(circle)) return;
    if (config_.flow == Flow::kNone) {
      plan_.verdict = {true,
                       fmt::format("nothing bounds the packets on the way: {} may put {} each on links of which a "
                                   "circle holds {} ({})",
                                   who(), each_, held(circle), named(circle))};
      return;
    }
    // Resources may have more places; those of routers are given.
    plan_.room_for_all = true;
    const std::vector<std::uint32_t> of_routers = smallest(false);
    if (of_routers.empty())
      plan_.verdict = {false,
                       fmt::format("room: a circle of links holds {} packets ({}), and {} {} up to {} each on the "
                                   "way, so every resource has egress places for all of them",
                                   held(circle), named(circle), who(), put(), each_)};
    else if (!keeps(of_routers))
      plan_.verdict = {true, fmt::format("a circle of links holds {} packets ({}), and {} {} up to {} each on the way; "
                                         "routers with buffers: auto have room for all of them",
                                         held(of_routers), named(of_routers), who(), put(), each_)};
  }

 private:
  /// The circle that holds the fewest packets; any that holds no more than are on the way will do.
  std::vector<std::uint32_t> smallest(bool bounded_resources) const {
    std::vector<bool> bounded;
    for (std::size_t i = 0; i < graph_.nodes.size(); ++i)
      bounded.push_back(i < graph_.resources ? bounded_resources : graph_.nodes[i].drawn->buffers.has_value());
    Dependencies waits(graph_.links.size());
    for (std::size_t lane = 0; lane < graph_.lanes; ++lane) {
      const std::span<const ResourceId> round(plan_.successors[lane]);
      waits.join(
          visit_dependencies(graph_, routes_[lane], config_.visit == Visit::kAll ? round : round.first(0), bounded));
    }
    join_stop_rings(waits, graph_, rings_, few_places(graph_));
    return waits.smallest_circle(places_, on_the_way_);
  }
  std::uint64_t held(const std::vector<std::uint32_t>& circle) const {
    std::uint64_t sum = 0;
    for (const std::uint32_t link : circle) sum += places_[link];
    return sum;
  }
  /// Those who issue packets.
  std::string who() const {
    if (graph_.manager_of.empty()) return fmt::format("{} resource{}", issuers_, issuers_ == 1 ? "" : "s");
    return fmt::format("{} packet process{}", issuers_, issuers_ == 1 ? "" : "es");
  }
  const char* put() const { return issuers_ == 1 ? "puts" : "put"; }
  std::string named(const std::vector<std::uint32_t>& circle) const { return circle_text(graph_, circle); }
  /// The links of each lane are one ring: as many as nodes, all of which are resources that reach one another.
  bool is_rings() const {
    if (graph_.nodes.size() != graph_.resources || graph_.lanes_meet() || !rings_.empty()) return false;
    std::vector<std::uint32_t> links(graph_.lanes);
    for (const Graph::Link& link : graph_.links) ++links[direction_of(link)];
    return std::ranges::all_of(links, [&](std::uint32_t count) { return count == graph_.resources; });
  }
  /// Tells whether the rule of topology.flow keeps the circle from filling up, and fills in the verdict then.
  bool keeps(const std::vector<std::uint32_t>& circle) {
    if (circle.empty())
      plan_.verdict = {false, "no circle: links that wait for one another end at nodes with room for all packets"};
    else if (config_.flow == Flow::kCredits && on_the_way_ < held(circle))
      plan_.verdict = {false, fmt::format("credits: {} with at most {} packets each {} {} packets on the way, and the "
                                          "smallest circle of links holds {} ({}), so one place is always free",
                                          who(), each_, put(), on_the_way_, held(circle), named(circle))};
    else if (config_.flow == Flow::kBubble && is_rings() &&
             std::ranges::all_of(graph_.links, [](const Graph::Link& link) { return link.depth >= 2; }))
      plan_.verdict = {false,
                       fmt::format("bubble: the links {} one ring, and a packet enters only where two places of the "
                                   "link are free, so one stays free",
                                   graph_.lanes > 1 ? "of each lane are" : "are")};
    else
      return false;
    return true;
  }

  const TopologyConfig& config_;
  const Graph& graph_;
  const std::vector<config::StopRing>& rings_;
  const std::vector<Routes>& routes_;  // by lane
  TopologyPlan& plan_;
  std::uint64_t each_;  // packets of a resource that may be in a circle
  std::size_t issuers_;
  std::uint64_t on_the_way_;
  std::vector<std::uint64_t> places_;  // by link, with one to leave its first node
};

/// Packets go straight over the bus.
void plan_the_bus(const TopologyConfig& config, TopologyPlan& plan) {
  plan.direct = plan.room_for_all = true;
  plan.hubs.front() = TopologyPlan::Hub::kBus;  // there are no routers, and other nodes come behind it
  plan.verdict =
      config.flow == Flow::kNone
          ? verdict_of_flow(config)
          : DeadlockVerdict{false,
                            "bus: every resource has egress places for all packets there are, so a packet that the "
                            "bus brings is always taken in"};
}

}  // namespace

TopologyPlan plan_graph(const TopologyConfig& config) {
  if (!properties_of(config).has_packets) return plan_independent(config);
  const Graph graph = draw_checked(config);
  const std::vector<Routes> routes = routes_of(graph);
  const std::vector<config::StopRing> rings = config::stop_rings(config, graph);
  TopologyPlan plan;
  for (const Routes& of_lane : routes)
    plan.successors.push_back(config.tour == Tour::kNearest ? nearest_round(graph, of_lane)
                                                            : round_in_steps(config, 1));
  plan_wires(config, graph, rings, routes, plan);
  plan.flits_apart =
      rings.empty() &&
      std::ranges::all_of(
          graph.links, [&](const Graph::Link& link) { return link.bytes_per_cycle == config.link.bytes_per_cycle; }) &&
      std::ranges::all_of(graph.nodes, [](const Graph::Node& node) { return node.drawn->forward == Forward::kHead; });
  if (rings.empty())
    plan.channels = plan_channels(config, graph, routes.front());
  else  // which have no virtual channels
    plan.channels = {.channels = std::vector<std::uint32_t>(plan.wires.size(), 1),
                     .datelines = std::vector<bool>(plan.wires.size())};
  plan.packets_in_flight = packets_in_flight(config);
  plan.manager_of = graph.manager_of;
  if (graph.bus()) {
    plan_the_bus(config, plan);
    return plan;
  }
  plan.routed = true;
  if (config::lone_stop_ring_entry(config)) {
    plan.verdict = {false, stop_rings_text(graph, rings)};
    return plan;
  }
  VisitJudge(config, graph, rings, routes, plan).judge();
  if (!rings.empty()) plan.verdict.rule += "; " + stop_rings_text(graph, rings);
  return plan;
}

}  // namespace carousel::ringbus
