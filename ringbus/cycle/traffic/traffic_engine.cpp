#include "ringbus/cycle/traffic/traffic_engine.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <optional>

#include "core/system/error.h"
#include "ringbus/cycle/traffic/routed_node.h"
#include "ringbus/cycle/traffic/traffic_node.h"
#include "ringbus/cycle/traffic/traffic_plan.h"
#include "ringbus/cycle/traffic/traffic_ring.h"
#include "ringbus/protocol/flow_rules.h"
#include "ringbus/time/machine_clocks.h"
#include "ringbus/time/windows.h"
#include "ringbus/topology/drawn_shape.h"
#include "ringbus/topology/shapes.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus {

namespace cycle {

namespace {

/// Builds the nodes of a network and the links between them, and runs them. Each node and link goes by its own clock.
class TrafficRun {
 public:
  TrafficRun(const Config& config, const RunOptions& options)
      : config_(config),
        options_(options),
        topology_(config.topology, plan_traffic(config.topology)),
        rings_(config.topology),
        flow_(config.topology.flow, topology_.direct() || topology_.routed()),
        ends_(traffic_ends(config.topology, config.workload.traffic)),
        plan_(config.workload.traffic, static_cast<std::uint64_t>(config.image.seed), topology_.resources(), ends_),
        clocks_(config.engine.clock_mhz, config.clocks.synchroniser_cycles) {
    const TrafficConfig& traffic = config.workload.traffic;
    const auto width = static_cast<std::uint64_t>(config.topology.link.bytes_per_cycle);
    const MessageKind packets = channels_.carry({"packets", "resources", "neighbours", "links", width},
                                                static_cast<std::uint64_t>(traffic.packet_bytes));
    const MessageKind deliveries =
        channels_.carry({"deliveries", "resources", "neighbours", "wires beside the links", width}, kAckBytes);
    for (std::size_t i = 0; i < topology_.wires().size(); ++i) {
      const Topology::Wire& wire = topology_.wires()[i];
      const ChannelEnds ends{wire.from.value, wire.to.value, static_cast<Cycle>(wire.latency_cycles)};
      first_wire_.push_back(wires_.size());
      for (std::uint32_t n = 0; n < (topology_.routed() ? topology_.channels().channels[i] : 1); ++n) {
        wires_.push_back(std::make_unique<WireOf<TrafficToken>>(channels_.at(packets, ends)));
        wires_.back()->packets.cross(clocks_.between(wire.mhz, topology_.mhz(wire.to)),
                                     clocks_.between(wire.mhz, topology_.mhz(wire.from)));
      }
      clocks_.use(wire.mhz);
      if (flow_.counts_deliveries())
        acks_.push_back(std::make_unique<Channel<TrafficAck>>(channels_.at(deliveries, ends)));
    }
    first_wire_.push_back(wires_.size());
    for (std::uint32_t n = 0; n < topology_.resources() + topology_.hubs().size(); ++n)
      clocks_.use(topology_.mhz(ResourceId(n)));
    TrafficNodeSettings settings = traffic_node_settings(traffic, config.topology.link);
    if (topology_.routed()) {
      if (topology_.flits_apart()) settings.pieces = settings.flits;
      add_routed(settings);
      return;
    }
    for (std::uint32_t r = 0; r < topology_.resources(); ++r) {
      TrafficSource source(traffic, static_cast<std::uint64_t>(config.image.seed), topology_.resources(), ends_,
                           ResourceId(r), plan_.gap);
      nodes_.push_back(std::make_unique<TrafficNode>(ResourceId(r), topology_, flow_, settings, std::move(source),
                                                     plan_.packets[r], plan_.window, ports_of(ResourceId(r))));
    }
  }

  TrafficResult run() {
    const auto start = std::chrono::steady_clock::now();
    const std::vector<std::vector<Agent*>> parts = share_out();
    auto last_report = start;
    bool stopped = false;
    WakeupTable wakeups(parts);
    std::vector<const Agent*> agents;
    for (std::uint32_t n = 0; n < nodes_.size(); ++n) {
      nodes_[n]->run_by(clocks_.to_fastest(topology_.mhz(ResourceId(n))));
      agents.push_back(nodes_[n].get());
    }
    channels_.connect(wakeups, agents);
    const Sharing sharing = config_.engine.threads ? Sharing::kAlways : Sharing::kWhenFaster;
    run_windows(parts, wakeups, std::min(link_latency(), channels_.least_latency()), sharing, [&](Cycle reached) {
      stopped = options_.stop.stop_requested();
      const auto now = std::chrono::steady_clock::now();
      if (options_.progress && now - last_report > std::chrono::milliseconds(200)) {
        last_report = now;
        const auto all = static_cast<double>(clocks_.to_fastest(0).to_network(plan_.window.end));
        const double done = std::min(1.0, static_cast<double>(reached) / all);
        options_.progress(static_cast<std::uint64_t>(done * static_cast<double>(config_.workload.traffic.packets)));
      }
      return !stopped;
    });
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    if (!stopped) check_at_rest();
    TrafficResult out = result();
    out.complete = !stopped;
    out.wall_seconds = wall.count();
    out.threads = parts.size();
    return out;
  }

 private:
  static constexpr std::uint64_t kAckBytes = 4;  // source and direction

  Cycle link_latency() const { return static_cast<Cycle>(config_.topology.link.latency_cycles); }

  /// Of the cycles of a link and of the node before it, those in which the node behind it lets a head claim a channel.
  /// A link with another clock than its nodes has none, since its cycles are not those of the claim.
  Cycle claims_on(const Topology::Wire& wire) const {
    if (wire.mhz != topology_.mhz(wire.from) || wire.mhz != topology_.mhz(wire.to)) return 0;
    return std::min<Cycle>(topology_.claim_cycles(wire.to), static_cast<Cycle>(wire.node_cycles));
  }

  /// The nodes of a graph: resources, which have sources, routers, and rings whose stops have no queues.
  void add_routed(const TrafficNodeSettings& settings) {
    const auto resources = static_cast<std::uint32_t>(topology_.resources());
    for (std::uint32_t n = 0; n < resources + topology_.hubs().size(); ++n) {
      TrafficNodeSettings node = settings;
      node.clock = clocks_.from_core(topology_.mhz(ResourceId(n)));
      std::optional<TrafficSource> source;
      if (n < resources)
        source.emplace(config_.workload.traffic, static_cast<std::uint64_t>(config_.image.seed), resources, ends_,
                       ResourceId(n), plan_.gap);
      RoutedNode::Ports ports = routed_ports(ResourceId(n), settings.pieces);
      if (topology_.ring(ResourceId(n)) != nullptr) {
        auto ring = std::make_unique<TrafficRing>(ResourceId(n), config_.topology, topology_, node, plan_.window,
                                                  std::move(ports.in), std::move(ports.out));
        stop_rings_.push_back(ring.get());
        nodes_.push_back(std::move(ring));
        continue;
      }
      nodes_.push_back(std::make_unique<RoutedNode>(ResourceId(n), topology_, rings_, node, clocks_, std::move(source),
                                                    n < resources ? plan_.packets[n] : 0, plan_.window,
                                                    std::move(ports)));
    }
  }

  RoutedNode::Ports routed_ports(ResourceId id, std::uint16_t pieces) const {
    const std::int64_t own = topology_.mhz(id);
    const bool ring = topology_.ring(id) != nullptr;
    RoutedNode::Ports ports;
    for (const std::uint32_t i : topology_.ports(id).in) {
      const Topology::Wire& wire = topology_.wires()[i];
      const bool crosses = wire.mhz != own;
      std::shared_ptr<const FarClock> far;
      if (crosses)
        far = std::make_shared<const FarClock>(
            FarClock{clocks_.between(own, wire.mhz), static_cast<Cycle>(wire.credit_cycles)});
      ports.claims.push_back(claims_on(wire));
      for (std::size_t w = first_wire_[i]; w < first_wire_[i + 1]; ++w)
        ports.in.push_back(
            {wires_[w].get(), static_cast<Cycle>(wire.latency_cycles + (crosses ? 0 : wire.credit_cycles)), far});
    }
    for (const std::uint32_t i : topology_.ports(id).out) {
      const Topology::Wire& wire = topology_.wires()[i];
      const bool crosses = wire.mhz != own;
      const Cycle node_cycles = crosses ? 0 : static_cast<Cycle>(wire.node_cycles) - claims_on(wire);
      // Where packets get off a ring there is room for all, unless the node has few places.
      const std::size_t places = !ring ? 1 : wire.places > 0 ? wire.places : std::numeric_limits<std::size_t>::max();
      for (std::size_t w = first_wire_[i]; w < first_wire_[i + 1]; ++w) {
        ports.out.emplace_back(*wires_[w], static_cast<Cycle>(wire.latency_cycles) + node_cycles,
                               static_cast<std::uint32_t>(wire.depth) * pieces, places);
        if (crosses) ports.out.back().cross(clocks_.between(own, wire.mhz), static_cast<Cycle>(wire.node_cycles));
      }
    }
    return ports;
  }

  TrafficNode::Ports ports_of(ResourceId id) const {
    TrafficNode::Ports ports;
    const std::uint32_t depth = static_cast<std::uint32_t>(config_.topology.link.depth);
    for (const std::uint32_t i : topology_.ports(id).in) {
      ports.in.push_back({wires_[i].get(), link_latency()});
      if (flow_.counts_deliveries()) ports.acks_in.push_back(acks_[i].get());
    }
    for (const std::uint32_t i : topology_.ports(id).out) {
      ports.out.emplace_back(*wires_[i], link_latency(), depth, 1);
      if (flow_.counts_deliveries()) ports.acks_out.push_back(acks_[i].get());
    }
    return ports;
  }

  /// Neighbours go to the same thread.
  std::vector<std::vector<Agent*>> share_out() const {
    const std::size_t threads = std::clamp<std::size_t>(options_.threads, 1, nodes_.size());
    std::vector<std::vector<Agent*>> parts(threads);
    for (std::size_t r = 0; r < nodes_.size(); ++r) parts[r * threads / nodes_.size()].push_back(nodes_[r].get());
    return parts;
  }

  void check_at_rest() const {
    std::string waiting;
    for (const auto& node : nodes_)
      if (const std::string text = node->describe(); !text.empty()) waiting += "\n  " + text;
    if (!waiting.empty()) throw SimulationError("nothing moves any more; who waits for whom:" + waiting);
  }

  TrafficResult result() const {
    TrafficResult out;
    out.window_begin = plan_.window.begin;
    out.window_end = plan_.window.end;
    out.packets = static_cast<std::uint64_t>(config_.workload.traffic.packets);
    out.flits = traffic_node_settings(config_.workload.traffic, config_.topology.link).flits;
    for (const auto& node : nodes_) {
      const TrafficOffered offered = node->offered();
      out.cycles = std::max(out.cycles, node->sink().last() + 1);
      out.delivered += node->sink().delivered();
      out.offered += offered.packets;
      out.accepted += node->sink().accepted();
      out.accepted_flit_hops += node->sink().accepted_hops() * out.flits;
      out.routers += offered.routers;
      out.travel += offered.travel;
      out.latency.add(node->sink().latency());
    }
    for (const Topology::Wire& wire : topology_.wires()) {
      const TrafficAgent& node = *nodes_[wire.from.value];
      const std::size_t exit = topology_.out_port_of(out.links.size());
      const TrafficAgent::Moved moved = node.moved(exit);
      out.busy_in_window.push_back(node.busy_in_window(exit));
      Occupancy queue;  // of all its channels
      for (std::size_t i = first_wire_[out.links.size()]; i < first_wire_[out.links.size() + 1]; ++i) {
        queue.packet_cycles += wires_[i]->queue.packet_cycles;
        queue.most = std::max(queue.most, wires_[i]->queue.most);
      }
      const ClockRatio to_link = clocks_.from_core(wire.mhz);
      const Cycle cycles = to_link.to_network(out.cycles);
      const Cycle stalled = clocks_.between(topology_.mhz(wire.from), wire.mhz).floor_to_network(moved.stalled);
      out.link_cycles.push_back(cycles);
      out.link_windows.push_back(to_link.to_network(out.window_end) - to_link.to_network(out.window_begin));
      out.links.push_back({wire.from.value,
                           wire.to.value,
                           {moved.busy, std::min(stalled, cycles - std::min(cycles, moved.busy))},
                           queue,
                           0,
                           wire.mhz});
      out.link_packets.push_back(moved.packets);
      out.link_depths.push_back(static_cast<std::uint64_t>(wire.depth));
      out.flit_hops += moved.packets * out.flits;
    }
    for (const TrafficRing* ring : stop_rings_) add_ring(ring->docks(), out);
    return out;
  }

  /// The links between the stops of a ring follow all others.
  void add_ring(const RingDocks<TrafficToken>& docks, TrafficResult& out) const {
    (out.stops ? *out.stops : out.stops.emplace()) += docks.fabric().use();
    const config::StopRing& ring = docks.shape().drawn;
    const ClockRatio clock = clocks_.from_core(ring.drawn->mhz);
    for (std::size_t i = ring.first; i < ring.first + ring.links(); ++i) {
      const config::Graph::Link& link = docks.graph().links[i];
      const RingLinks::Use& use = docks.fabric().links().all()[i];
      out.links.push_back({link.from, link.to, {use.busy, 0}, {}, 0, link.mhz});
      out.link_cycles.push_back(clock.to_network(out.cycles));
      out.link_windows.push_back(clock.to_network(out.window_end) - clock.to_network(out.window_begin));
      out.link_packets.push_back(use.packets);
      out.link_depths.push_back(docks.shape().hop);
      out.busy_in_window.push_back(use.in_window);
      out.flit_hops += use.busy;
    }
  }

  const Config& config_;
  const RunOptions& options_;
  Topology topology_;
  RingTimes rings_;
  FlowRules flow_;
  TrafficEnds ends_;
  TrafficPlan plan_;
  MachineClocks clocks_;
  ChannelList channels_;
  std::vector<std::unique_ptr<WireOf<TrafficToken>>> wires_;  // as topology_.wires(), each with its virtual channels
  std::vector<std::size_t> first_wire_;                       // by link, and behind the last
  std::vector<std::unique_ptr<Channel<TrafficAck>>> acks_;    // beside them
  std::vector<std::unique_ptr<TrafficAgent>> nodes_;          // resources, then routers, then rings
  std::vector<const TrafficRing*> stop_rings_;                // of these
};

}  // namespace

}  // namespace cycle

TrafficResult run_traffic(const Config& config, const RunOptions& options) {
  if (config.topology.shape != TopologyShape::kHierarchical) return cycle::TrafficRun(config, options).run();
  // Its lines and the ring of its bridges are a graph, through which packets with one destination find their way.
  Config drawn = config;
  drawn.topology = draw_shape(config.topology).config;
  return cycle::TrafficRun(drawn, options).run();
}

}  // namespace carousel::ringbus
