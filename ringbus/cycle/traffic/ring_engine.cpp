#include "ringbus/cycle/traffic/ring_engine.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/system/error.h"
#include "ringbus/cycle/rings/ring_fabric.h"
#include "ringbus/cycle/traffic/ring_station.h"
#include "ringbus/topology/graph_facts.h"

namespace carousel::ringbus {

namespace cycle {

namespace {

/// Builds a ring with its stops, and runs it.
class RingRun {
 public:
  RingRun(const TopologyConfig& topology, const TrafficConfig& traffic, const ClockRatio& clock, std::uint64_t seed,
          const RunOptions& options)
      : topology_(topology),
        traffic_(traffic),
        clock_(clock),
        seed_(seed),
        options_(options),
        graph_(draw_checked(topology)),
        shape_(config::stop_rings(topology, graph_).front()),
        ends_(traffic_ends(topology, traffic)),
        plan_(traffic, seed, graph_.resources, ends_),
        places_(graph_.resources) {
    const std::vector<std::uint32_t>& nodes = shape_.drawn.nodes;
    for (std::uint32_t place = 0; place < nodes.size(); ++place)
      if (nodes[place] < graph_.resources) places_[nodes[place]] = place;
    const RingLinks links(graph_.links.size(),
                          {clock_.to_network(plan_.window.begin), clock_.to_network(plan_.window.end)});
    add_stations();
    std::vector<RingEnd*> ends;
    for (RingStation& station : stations_) ends.push_back(&station);
    fabric_ = make_ring(shape_, std::move(ends), links);
  }

  TrafficResult run() {
    const auto start = std::chrono::steady_clock::now();
    auto last_report = start;
    constexpr std::uint64_t kLook = 1 << 12;  // steps between two looks at the host's clock
    bool stopped = false;
    std::uint64_t steps = 0;
    for (Cycle now; !stopped && (now = fabric_->next()) != kNever;) {
      fabric_->step(now);
      if (++steps % kLook != 0) continue;
      stopped = options_.stop.stop_requested();
      const auto time = std::chrono::steady_clock::now();
      if (!options_.progress || time - last_report <= std::chrono::milliseconds(200)) continue;
      last_report = time;
      const double done =
          std::min(1.0, static_cast<double>(clock_.to_core(now)) / static_cast<double>(plan_.window.end));
      options_.progress(static_cast<std::uint64_t>(done * static_cast<double>(traffic_.packets)));
    }
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    TrafficResult out = result();
    out.complete = !stopped;
    out.wall_seconds = wall.count();
    if (out.complete && out.delivered != out.packets)
      throw SimulationError(
          fmt::format("the ring has lost packets: {} created, {} delivered", out.packets, out.delivered));
    return out;
  }

 private:
  void add_stations() {
    const RingStation::Settings settings{traffic_node_settings(traffic_, topology_.link, clock_),
                                         static_cast<std::uint32_t>(traffic_.reply_bytes),
                                         static_cast<Cycle>(traffic_.serve_cycles)};
    for (std::uint32_t place = 0; place < shape_.stops; ++place) {
      const std::uint32_t node = shape_.drawn.nodes[place];
      std::optional<TrafficSource> source;
      if (node < graph_.resources)
        source.emplace(traffic_, seed_, graph_.resources, ends_, ResourceId(node), plan_.gap);
      const std::uint64_t packets = source ? plan_.packets[node] : 0;
      stations_.emplace_back(place, shape_, places_, settings, std::move(source), packets, plan_.window);
    }
  }

  TrafficResult result() const {
    TrafficResult out;
    out.window_begin = plan_.window.begin;
    out.window_end = plan_.window.end;
    out.packets = static_cast<std::uint64_t>(traffic_.packets);
    out.flits = shape_.flits(static_cast<std::uint64_t>(traffic_.packet_bytes));
    for (const RingStation& station : stations_) {
      const TrafficSink& sink = station.sink();
      const TrafficOffered offered = station.offered();
      out.cycles = std::max(out.cycles, sink.last() + 1);
      out.delivered += sink.delivered();
      out.offered += offered.packets;
      out.accepted += sink.accepted();
      out.accepted_flit_hops += sink.accepted_hops();
      out.routers += offered.routers;
      out.travel += offered.travel;
      out.latency.add(sink.latency());
    }
    const Cycle cycles = clock_.to_network(out.cycles),
                window = clock_.to_network(out.window_end) - clock_.to_network(out.window_begin);
    for (std::size_t i = 0; i < graph_.links.size(); ++i) {
      const RingLinks::Use& use = fabric_->links().all()[i];
      out.links.push_back({graph_.links[i].from, graph_.links[i].to, {use.busy, 0}, {}, 0, graph_.links[i].mhz});
      out.link_cycles.push_back(cycles);
      out.link_windows.push_back(window);
      out.link_packets.push_back(use.packets);
      out.link_depths.push_back(shape_.hop);
      out.busy_in_window.push_back(use.in_window);
      out.flit_hops += use.busy;
    }
    out.stops = fabric_->use();
    return out;
  }

  const TopologyConfig& topology_;
  const TrafficConfig& traffic_;
  ClockRatio clock_;
  std::uint64_t seed_;
  const RunOptions& options_;
  config::Graph graph_;
  RingShape shape_;
  TrafficEnds ends_;
  TrafficPlan plan_;
  std::vector<std::uint32_t> places_;  // stops of the resources
  std::vector<RingStation> stations_;  // by stop
  std::unique_ptr<RingFabric> fabric_;
};

}  // namespace

}  // namespace cycle

TrafficResult run_ring_traffic(const TopologyConfig& topology, const TrafficConfig& traffic, const ClockRatio& clock,
                               std::int64_t seed, const RunOptions& options) {
  return cycle::RingRun(topology, traffic, clock, static_cast<std::uint64_t>(seed), options).run();
}

}  // namespace carousel::ringbus
