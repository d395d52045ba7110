#include "ringbus/cycle/cycle_engine.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/system/error.h"
#include "ringbus/cycle/fabric/bridge.h"
#include "ringbus/cycle/fabric/bus.h"
#include "ringbus/cycle/machine/cycle_machine.h"
#include "ringbus/cycle/memory/memory.h"
#include "ringbus/cycle/memory/shape_cache.h"
#include "ringbus/cycle/shading/shading_agent.h"
#include "ringbus/cycle/tile/independent_tile.h"
#include "ringbus/cycle/tile/tile.h"
#include "ringbus/cycle/time/wait_cycle.h"
#include "ringbus/cycle/time/windows.h"

namespace carousel::ringbus {

namespace cycle {

namespace {

/// Builds the agents and the channels between them, and runs them.
class CycleRun {
 public:
  CycleRun(const Config& config, const accel::Accel& accel, float scene_size, Workload& workload,
           const RunOptions& options)
      : config_(config), options_(options), machine_(config, accel, scene_size) {
    const std::size_t resources = machine_.topology.resources();
    make_wires();
    std::vector<SidePorts> sides;
    std::vector<ShapeCache::Client> cache_clients;
    for (std::uint32_t r = 0; r < resources; ++r) {
      SidePorts& side = sides.emplace_back();
      side.new_rays = new_rays_.emplace_back(std::make_unique<Channel<NewRays>>()).get();
      side.completed = completed_.emplace_back(std::make_unique<Channel<CompletedRays>>()).get();
      side.fetch = fetches_.emplace_back(std::make_unique<Channel<FetchRequest>>()).get();
      side.fetched = answers_.emplace_back(std::make_unique<Channel<FetchAnswer>>()).get();
      if (config.shading.idle_resources_shade) {
        side.jobs = jobs_.emplace_back(std::make_unique<Channel<ShadeJob>>()).get();
        side.help = help_.emplace_back(std::make_unique<Channel<HelpNote>>()).get();
      }
      if (machine_.calls_shader()) {
        side.questions = questions_.emplace_back(std::make_unique<Channel<AnyHitQuestion>>()).get();
        side.answers = opacities_.emplace_back(std::make_unique<Channel<AnyHitAnswer>>()).get();
      }
      cache_clients.push_back({side.fetch, side.fetched});
      tiles_.push_back(make_tile(ResourceId(r), side, scene_size));
    }
    shading_ = std::make_unique<ShadingAgent>(machine_, workload, options.trace, std::move(sides));
    make_memory(cache_clients);
    make_hubs();
  }

  RunResult run() {
    const auto start = std::chrono::steady_clock::now();
    const std::vector<std::vector<Agent*>> parts = share_out();
    auto last_report = start;
    bool stopped = false;
    WakeupTable wakeups(parts);
    connect(wakeups);
    const Cycle reached = run_windows(parts, wakeups, lookahead(), [&](Cycle) {
      stopped = options_.stop.stop_requested();
      const auto now = std::chrono::steady_clock::now();
      if (options_.progress && now - last_report > std::chrono::milliseconds(200)) {
        last_report = now;
        options_.progress(shading_->completed());
      }
      return !stopped;
    });
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    if (!stopped) check_at_rest();
    RunResult out = result(reached + 1);
    out.complete = !stopped;
    out.wall_seconds = wall.count();
    out.threads = parts.size();
    return out;
  }

 private:
  std::unique_ptr<ResourceAgent> make_tile(ResourceId id, const SidePorts& side, float scene_size) {
    if (!machine_.topology.has_packets())
      return std::make_unique<IndependentTile>(id, machine_, options_.statistics, options_.trace, side);
    return std::make_unique<Tile>(id, machine_, scene_size, options_.statistics, options_.trace, ports_of(id, side));
  }

  void make_wires() {
    for (std::size_t i = 0; i < machine_.topology.wires().size(); ++i) wires_.push_back(std::make_unique<Wire>());
  }

  /// The links at a node, in the order of the topology's wires; a ring's by direction, for what comes in by one
  /// direction leaves by the same, and so a bridge's.
  struct NodePorts {
    std::vector<InPort> in;
    std::vector<OutPort> out;
  };
  NodePorts ports_at(ResourceId node) const {
    NodePorts ports;
    const Topology& topology = machine_.topology;
    const std::uint32_t depth = static_cast<std::uint32_t>(config_.topology.link.depth);
    const bool hub = node.value >= topology.resources();
    // In hand at a resource: the packets in test, and one that passes meanwhile. At a hub, and wherever packets go
    // straight to their next stop, all there are fit in, as nothing else would keep circles of links from closing.
    const std::size_t places =
        hub || topology.direct() ? machine_.packets.size() : static_cast<std::size_t>(config_.testers.contexts) + 1;
    for (const std::uint32_t i : topology.ports(node).in)
      ports.in.push_back({wires_[i].get(), latency_of(topology.wires()[i])});
    for (const std::uint32_t i : topology.ports(node).out) {
      const Cycle latency = latency_of(topology.wires()[i]);
      ports.out.emplace_back(*wires_[i], latency, depth, places);
      if (config_.faults.links.any())
        ports.out.back().fail(LinkFaultTimer(config_.faults.links, config_.faults.seed, i, latency));
    }
    return ports;
  }

  Cycle latency_of(const Topology::Wire& wire) const { return static_cast<Cycle>(wire.latency_cycles); }

  Tile::Ports ports_of(ResourceId id, const SidePorts& side) const {
    NodePorts node = ports_at(id);
    return {side, std::move(node.in), std::move(node.out)};
  }

  void make_hubs() {
    const Topology& topology = machine_.topology;
    for (std::uint32_t hub = 0; hub < topology.hubs().size(); ++hub) {
      NodePorts ports = ports_at(ResourceId(static_cast<std::uint32_t>(topology.resources()) + hub));
      switch (topology.hubs()[hub]) {
        case Topology::Hub::kBus:
          bus_ = std::make_unique<Bus>(machine_, std::move(ports.in), std::move(ports.out));
          break;
        case Topology::Hub::kBridge:
          bridges_.push_back(std::make_unique<Bridge>(hub, machine_, std::move(ports.in), std::move(ports.out)));
          break;
      }
    }
  }

  /// The near ends of the links that leave a node.
  const std::vector<OutPort>& out_of(ResourceId node) const {
    const std::size_t resources = machine_.topology.resources();
    if (node.value < resources) return tiles_[node.value]->out();
    return bus_ ? bus_->out() : bridges_[node.value - resources]->out();
  }

  void make_memory(const std::vector<ShapeCache::Client>& clients) {
    std::vector<Memory::Client> memory_clients;
    const std::size_t shared_by = static_cast<std::size_t>(config_.memory.shared_by);
    for (std::size_t first = 0; first < clients.size(); first += shared_by) {
      const std::size_t last = std::min(clients.size(), first + shared_by);
      Channel<std::uint64_t>& down = *lines_.emplace_back(std::make_unique<Channel<std::uint64_t>>());
      Channel<std::uint64_t>& up = *lines_.emplace_back(std::make_unique<Channel<std::uint64_t>>());
      caches_.push_back(std::make_unique<ShapeCache>(
          config_.memory,
          std::vector<ShapeCache::Client>(clients.begin() + static_cast<std::ptrdiff_t>(first),
                                          clients.begin() + static_cast<std::ptrdiff_t>(last)),
          down, up));
      memory_clients.push_back({&down, &up});
    }
    memory_ = std::make_unique<Memory>(config_.memory, std::move(memory_clients));
  }

  /// The least latency of any channel.
  Cycle lookahead() const {
    Cycle least = control_latency(config_);
    for (const Topology::Wire& wire : machine_.topology.wires()) least = std::min(least, latency_of(wire));
    return std::min({least, ShapeCache::request_latency(config_.memory), ShapeCache::answer_latency(config_.memory),
                     Memory::request_latency(config_.memory), Memory::answer_latency(config_.memory)});
  }

  /// Neighbours go to the same thread, and each cache to the thread of its resources; shading and memory to the last.
  std::vector<std::vector<Agent*>> share_out() const {
    const std::size_t threads = std::clamp<std::size_t>(options_.threads, 1, tiles_.size());
    std::vector<std::vector<Agent*>> parts(threads);
    for (std::size_t r = 0; r < tiles_.size(); ++r) parts[r * threads / tiles_.size()].push_back(tiles_[r].get());
    for (std::size_t c = 0; c < caches_.size(); ++c) parts[c * threads / caches_.size()].push_back(caches_[c].get());
    for (std::size_t g = 0; g < bridges_.size(); ++g) parts[g * threads / bridges_.size()].push_back(bridges_[g].get());
    if (bus_) parts.front().push_back(bus_.get());
    parts.back().push_back(memory_.get());
    parts.back().push_back(shading_.get());
    return parts;
  }

  const Agent& node(ResourceId id) const {
    if (id.value < tiles_.size()) return *tiles_[id.value];
    if (bus_) return *bus_;
    return *bridges_[id.value - tiles_.size()];
  }

  /// Everything but credits, for which agents look when they need any.
  void connect(WakeupTable& wakeups) const {
    for (std::size_t i = 0; i < wires_.size(); ++i) {
      const Topology::Wire& wire = machine_.topology.wires()[i];
      wakeups.connect(wires_[i]->packets, node(wire.from), node(wire.to));
    }
    for (std::size_t r = 0; r < tiles_.size(); ++r) {
      const ShapeCache& cache = *caches_[r / static_cast<std::size_t>(config_.memory.shared_by)];
      wakeups.connect(*new_rays_[r], *shading_, *tiles_[r]);
      wakeups.connect(*completed_[r], *tiles_[r], *shading_);
      wakeups.connect(*fetches_[r], *tiles_[r], cache);
      wakeups.connect(*answers_[r], cache, *tiles_[r]);
      if (!questions_.empty()) {
        wakeups.connect(*questions_[r], *tiles_[r], *shading_);
        wakeups.connect(*opacities_[r], *shading_, *tiles_[r]);
      }
      if (jobs_.empty()) continue;
      wakeups.connect(*jobs_[r], *shading_, *tiles_[r]);
      wakeups.connect(*help_[r], *tiles_[r], *shading_);
    }
    for (std::size_t c = 0; c < caches_.size(); ++c) {
      wakeups.connect(*lines_[2 * c], *caches_[c], *memory_);
      wakeups.connect(*lines_[2 * c + 1], *memory_, *caches_[c]);
    }
  }

  /// Calls `body` with each wire and which of its node's exits it is.
  template <class Body>
  void for_each_link(const Body& body) const {
    std::vector<std::size_t> exits(tiles_.size() + bridges_.size() + 1);
    for (const Topology::Wire& wire : machine_.topology.wires()) body(wire, exits[wire.from.value]++);
  }

  void check_at_rest() const {
    std::string waiting = shading_->describe();
    const auto ask = [&](const Agent& agent) {
      if (const std::string text = agent.describe(); !text.empty()) waiting += "\n  " + text;
    };
    for (const auto& tile : tiles_) ask(*tile);
    for (const auto& bridge : bridges_) ask(*bridge);
    std::vector<Wait> waits;
    for_each_link([&](const Topology::Wire& wire, std::size_t exit) {
      if (wire.from.value >= tiles_.size()) return;
      if (std::string packet = tiles_[wire.from.value]->blocked(exit); !packet.empty())
        waits.push_back({wire.from.value, wire.to.value, std::move(packet)});
    });
    if (const std::string circle = wait_cycle(waits); !circle.empty()) waiting += "\n  " + circle;
    if (!shading_->done() || !waiting.empty())
      throw SimulationError("nothing moves any more; who waits for whom:\n  " + waiting);
  }

  RunResult result(Cycle end) const {
    RunResult out;
    out.rays_emitted = shading_->emitted();
    out.rays_completed = shading_->completed();
    out.slots_used = machine_.control.slots_used();
    out.slot_waits = machine_.control.slot_waits();
    CycleResult& c = out.cycle.emplace();
    c.cycles = end;
    c.shading_busy = shading_->busy();
    out.rays_restarted = shading_->rays_restarted();
    out.paths_restarted = shading_->paths_restarted();
    if (shading_->stop() && shading_->stop()->noticed > 0) c.stop = shading_->stop();
    for (const auto& tile : tiles_) out.packets_discarded += tile->packets_discarded();
    c.memory_lines = memory_->lines();
    c.memory_busy = memory_->busy();
    steady(c);
    std::vector<const Trace*> traces{&shading_->trace()};
    for (const auto& tile : tiles_) traces.push_back(&tile->trace());
    c.epochs = combine(traces);
    c.steps = merge_steps(traces);
    for (const auto& tile : tiles_) {
      tile->close(end);
      if (options_.statistics) out.resources.push_back(tile->statistics());
      out.collections.push_back(tile->collections());
      c.tiles.push_back(tile->result());
    }
    for_each_link([&](const Topology::Wire& wire, std::size_t exit) {
      const OutPort& port = out_of(wire.from)[exit];
      c.hops += port.packets();
      c.links.push_back({wire.from.value, wire.to.value, {port.busy(), port.stalled()}, wires_[c.links.size()]->queue});
      LinkStatistics s;
      s.packets = port.packets();
      out.links.push_back(
          {wire.from, wire.to, static_cast<std::size_t>(config_.topology.link.depth), s, {}, port.faults()});
    });
    for (const auto& cache : caches_) c.caches.push_back(cache->statistics());
    return out;
  }

  void steady(CycleResult& c) const {
    const std::vector<ShadingAgent::Milestone>& m = shading_->milestones();
    const std::uint64_t all = shading_->completed();
    const auto quarter = [&](std::uint64_t n) {
      return std::find_if(m.begin(), m.end(), [&](const auto& x) { return 4 * x.completed >= n * all; });
    };
    const auto first = quarter(1), middle = quarter(2), last = quarter(3);
    if (last == m.end() || last->at == middle->at || middle->at == first->at) return;
    c.steady_cycles = last->at - first->at;
    c.steady_rays = last->completed - first->completed;
    const auto rate = [](const auto& from, const auto& to) {
      return static_cast<double>(to->completed - from->completed) / static_cast<double>(to->at - from->at);
    };
    c.steady_spread = std::abs(rate(middle, last) - rate(first, middle)) / rate(first, last);
  }

  const Config& config_;
  const RunOptions& options_;
  CycleMachine machine_;
  std::vector<std::unique_ptr<Wire>> wires_;  // as the topology's
  std::vector<std::unique_ptr<Channel<NewRays>>> new_rays_;
  std::vector<std::unique_ptr<Channel<CompletedRays>>> completed_;
  std::vector<std::unique_ptr<Channel<FetchRequest>>> fetches_;
  std::vector<std::unique_ptr<Channel<FetchAnswer>>> answers_;
  std::vector<std::unique_ptr<Channel<ShadeJob>>> jobs_;
  std::vector<std::unique_ptr<Channel<HelpNote>>> help_;
  std::vector<std::unique_ptr<Channel<AnyHitQuestion>>> questions_;
  std::vector<std::unique_ptr<Channel<AnyHitAnswer>>> opacities_;
  std::vector<std::unique_ptr<Channel<std::uint64_t>>> lines_;
  std::vector<std::unique_ptr<ResourceAgent>> tiles_;
  std::vector<std::unique_ptr<ShapeCache>> caches_;
  std::vector<std::unique_ptr<Bridge>> bridges_;
  std::unique_ptr<Bus> bus_;
  std::unique_ptr<Memory> memory_;
  std::unique_ptr<ShadingAgent> shading_;
};

}  // namespace

}  // namespace cycle

RunResult run_cycle(const Config& config, const accel::Accel& accel, float scene_size, Workload& workload,
                    const RunOptions& options) {
  return cycle::CycleRun(config, accel, scene_size, workload, options).run();
}

}  // namespace carousel::ringbus
