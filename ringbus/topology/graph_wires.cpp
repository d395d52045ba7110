#include "ringbus/topology/graph_wires.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "ringbus/topology/graph_facts.h"

namespace carousel::ringbus {

using config::Graph;
using config::StopRing;

namespace {

class Wiring {
 public:
  Wiring(const TopologyConfig& config, const Graph& graph, const std::vector<StopRing>& rings,
         const std::vector<Routes>& routes, TopologyPlan& plan)
      : config_(config), graph_(graph), rings_(rings), routes_(routes), plan_(plan), wire_of_(graph.links.size()) {}

  void plan() {
    for (std::size_t i = graph_.resources; i < graph_.nodes.size(); ++i) {
      plan_.hubs.push_back(TopologyPlan::Hub::kRouter);
      plan_.hub_places.push_back(static_cast<std::uint32_t>(graph_.nodes[i].drawn->buffers.value_or(0)));
    }
    for (const Graph::Node& node : graph_.nodes) {
      plan_.claim_cycles.push_back(static_cast<std::uint32_t>(node.drawn->claim_cycles));
      plan_.node_mhz.push_back(node.drawn->mhz);
    }
    for (std::uint32_t i = 0; i < graph_.links.size(); ++i)
      if (ring_of(i) == nullptr) add_link(i);
    for (const StopRing& ring : rings_) add_ring(ring);
    add_exits();
  }

 private:
  const StopRing* ring_of(std::uint32_t link) const {
    const auto found = std::ranges::find_if(rings_, [&](const StopRing& ring) { return ring.owns(link); });
    return found == rings_.end() ? nullptr : &*found;
  }

  void add_link(std::uint32_t i) {
    const Graph::Link& link = graph_.links[i];
    const Graph::Node &from = graph_.nodes[link.from], &to = graph_.nodes[link.to];
    wire_of_[i] = static_cast<std::uint32_t>(plan_.wires.size());
    TopologyPlan::Wire& wire = plan_.wires.emplace_back();
    wire.from = ResourceId(link.from);
    wire.to = ResourceId(link.to);
    wire.direction = direction_of(link);
    wire.latency_cycles = link.latency_cycles;
    wire.node_cycles = from.drawn->latency_cycles;
    wire.depth = link.depth;
    wire.bytes_per_cycle = link.bytes_per_cycle;
    wire.credit_cycles = to.drawn->credit_cycles;
    wire.mhz = link.mhz;
    wire.queue = link.queue;
    if (from.at.given && to.at.given) wire.mm = link_mm(graph_, link);
  }

  void add_ring(const StopRing& ring) {
    const auto hub = static_cast<std::uint32_t>(graph_.resources + plan_.hubs.size());
    TopologyPlan::StopRing& out = plan_.rings.emplace_back();
    out.both = ring.directions() == 2;
    out.stops = ring.nodes;
    out.places.resize(graph_.nodes.size(), static_cast<std::uint32_t>(ring.nodes.size()));
    for (std::uint32_t place = 0; place < ring.nodes.size(); ++place) out.places[ring.nodes[place]] = place;
    plan_.hubs.push_back(TopologyPlan::Hub::kRing);
    plan_.hub_places.push_back(0);
    plan_.claim_cycles.push_back(0);
    plan_.node_mhz.push_back(ring.drawn->mhz);
    std::vector<std::uint32_t> stops = ring.nodes;
    std::ranges::sort(stops);
    std::vector<std::uint32_t> on(graph_.nodes.size());  // by node: its wire to the ring
    for (const std::uint32_t stop : stops) {
      on[stop] = static_cast<std::uint32_t>(plan_.wires.size());
      wire_to(ring, stop, hub).node_cycles = graph_.nodes[stop].drawn->latency_cycles;
    }
    for (const std::uint32_t stop : stops) {
      TopologyPlan::Wire& wire = wire_to(ring, hub, stop);
      wire.credit_cycles = graph_.nodes[stop].drawn->credit_cycles;
      wire.places = static_cast<std::uint32_t>(graph_.nodes[stop].drawn->buffers.value_or(0));
    }
    for (std::size_t i = ring.first; i < ring.first + ring.links(); ++i) wire_of_[i] = on[graph_.links[i].from];
    for (const std::uint32_t stop : ring.nodes)
      for (std::uint32_t to = 0; to < graph_.resources; ++to) {
        std::uint32_t at = stop;  // as far as the way stays on the ring
        for (std::uint32_t link; (link = routes_.front().link(at, to)) != Routes::kNone && ring.owns(link);)
          at = graph_.links[link].to;
        out.off.push_back(ResourceId(at));
      }
  }

  TopologyPlan::Wire& wire_to(const StopRing& ring, std::uint32_t from, std::uint32_t to) {
    TopologyPlan::Wire& one = plan_.wires.emplace_back();
    one.from = ResourceId(from);
    one.to = ResourceId(to);
    one.depth = config_.link.depth;
    one.bytes_per_cycle = ring.port_bytes_per_cycle();
    one.mm = 0;  // a stop stands beside its node
    one.mhz = ring.drawn->mhz;
    return one;
  }

  /// Tells whether the node at the end of a link sends what goes to `to` on when its head has come.
  bool through(std::uint32_t link, const Routes& routes, std::uint32_t to) const {
    if (ring_of(link) != nullptr) return true;  // the ring takes flits as they come
    const Graph::Link& here = graph_.links[link];
    const Graph::Node& node = graph_.nodes[here.to];
    const std::uint32_t next = here.to == to ? Routes::kNone : routes.link(here.to, to);
    const StopRing* const ring = next == Routes::kNone ? nullptr : ring_of(next);
    if (ring == nullptr) return goes_through(graph_, routes, link, to);
    return node.drawn->forward == Forward::kHead && ring->port_bytes_per_cycle() == here.bytes_per_cycle &&
           ring->drawn->mhz == here.mhz && node.drawn->mhz == here.mhz;
  }

  /// The exits of all nodes towards all resources, lane by lane.
  void add_exits() {
    const std::vector<TopologyPlan::Wire>& wires = plan_.wires;
    std::vector<std::uint16_t> ports(wires.size()), wires_of(graph_.nodes.size() + rings_.size());
    std::vector<std::uint32_t> in_order(wires.size());
    std::iota(in_order.begin(), in_order.end(), 0u);
    std::ranges::sort(in_order, {}, [&](std::uint32_t i) { return std::pair(wires[i].direction, wires[i].to.value); });
    for (const std::uint32_t i : in_order) ports[i] = wires_of[wires[i].from.value]++;
    plan_.exits.resize(wires_of.size() * graph_.lanes * graph_.resources);
    for (std::uint32_t at = 0; at < graph_.nodes.size(); ++at)
      for (std::size_t lane = 0; lane < graph_.lanes; ++lane)
        for (std::uint32_t to = 0; to < graph_.resources; ++to) {
          const std::uint32_t i = routes_[lane].link(at, to);
          if (i == Routes::kNone) continue;
          plan_.exits[(at * graph_.lanes + lane) * graph_.resources + to] = {ports[wire_of_[i]],
                                                                             through(i, routes_[lane], to)};
        }
  }

  const TopologyConfig& config_;
  const Graph& graph_;
  const std::vector<StopRing>& rings_;
  const std::vector<Routes>& routes_;
  TopologyPlan& plan_;
  std::vector<std::uint32_t> wire_of_;  // by link of the graph; of a ring's, that by which packets get onto it
};

}  // namespace

std::uint16_t direction_of(const Graph::Link& link) {
  return static_cast<std::uint16_t>(std::max<std::int64_t>(0, link.lane));
}

void plan_wires(const TopologyConfig& config, const Graph& graph, const std::vector<StopRing>& rings,
                const std::vector<Routes>& routes, TopologyPlan& plan) {
  Wiring(config, graph, rings, routes, plan).plan();
}

}  // namespace carousel::ringbus
