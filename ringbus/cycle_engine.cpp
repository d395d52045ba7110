#include "ringbus/cycle_engine.h"

#include <algorithm>
#include <memory>

#include "core/error.h"
#include "ringbus/cycle/cycle_machine.h"
#include "ringbus/cycle/memory.h"
#include "ringbus/cycle/shading_agent.h"
#include "ringbus/cycle/shape_cache.h"
#include "ringbus/cycle/tile.h"
#include "ringbus/cycle/windows.h"

namespace carousel::ringbus {

namespace cycle {

namespace {

/// Builds the agents and the channels between them, and runs them.
class CycleRun {
 public:
  CycleRun(const Config& config, const accel::Accel& accel, float scene_size, Workload& workload,
           const RunOptions& options)
      : config_(config), options_(options), machine_(config, accel) {
    const std::size_t resources = machine_.topology.resources();
    make_wires();
    std::vector<ShadingAgent::Client> shading_clients;
    std::vector<ShapeCache::Client> cache_clients;
    for (std::uint32_t r = 0; r < resources; ++r) {
      Tile::Ports ports = ports_of(ResourceId(r));
      ports.new_rays = new_rays_.emplace_back(std::make_unique<Channel<NewRays>>()).get();
      ports.completed = completed_.emplace_back(std::make_unique<Channel<CompletedRays>>()).get();
      ports.fetch = fetches_.emplace_back(std::make_unique<Channel<FetchRequest>>()).get();
      ports.fetched = answers_.emplace_back(std::make_unique<Channel<FetchAnswer>>()).get();
      shading_clients.push_back({ports.new_rays, ports.completed});
      cache_clients.push_back({ports.fetch, ports.fetched});
      tiles_.push_back(std::make_unique<Tile>(ResourceId(r), machine_, scene_size, options.statistics, std::move(ports)));
    }
    shading_ = std::make_unique<ShadingAgent>(machine_, workload, std::move(shading_clients));
    make_memory(cache_clients);
  }

  RunResult run() {
    const auto start = std::chrono::steady_clock::now();
    const std::vector<std::vector<Agent*>> parts = share_out();
    auto last_report = start;
    bool stopped = false;
    const Cycle reached = run_windows(parts, lookahead(), [&](Cycle) {
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
  void make_wires() {
    for (std::size_t i = 0; i < machine_.topology.wires().size(); ++i) wires_.push_back(std::make_unique<Wire>());
  }

  Tile::Ports ports_of(ResourceId id) {
    Tile::Ports ports;
    const std::vector<Topology::Wire>& wires = machine_.topology.wires();
    const Cycle latency = static_cast<Cycle>(config_.topology.link.latency_cycles);
    const bool point_to_point = machine_.topology.point_to_point();
    // In hand: the packets in test, and one that passes meanwhile. Point to point, all there are fit in, as nothing
    // else would keep the many cycles of links from closing.
    const std::size_t places = point_to_point ? machine_.packets.size() : static_cast<std::size_t>(config_.testers.contexts) + 1;
    if (point_to_point) ports.out_to.resize(machine_.topology.resources());
    for (std::size_t i = 0; i < wires.size(); ++i) {
      if (wires[i].to == id) {
        // A ring's come in by direction, to leave by the same.
        const std::size_t at = point_to_point ? ports.in.size() : wires[i].direction;
        if (ports.in.size() <= at) ports.in.resize(at + 1);
        ports.in[at] = {wires_[i].get(), latency};
      }
      if (wires[i].from != id) continue;
      if (point_to_point) ports.out_to[wires[i].to.value] = static_cast<std::uint32_t>(ports.out.size());
      ports.out.emplace_back(*wires_[i], latency, static_cast<std::uint32_t>(config_.topology.link.depth), places);
    }
    return ports;
  }

  void make_memory(const std::vector<ShapeCache::Client>& clients) {
    std::vector<Memory::Client> memory_clients;
    const std::size_t shared_by = static_cast<std::size_t>(config_.memory.shared_by);
    for (std::size_t first = 0; first < clients.size(); first += shared_by) {
      const std::size_t last = std::min(clients.size(), first + shared_by);
      Channel<std::uint64_t>& down = *lines_.emplace_back(std::make_unique<Channel<std::uint64_t>>());
      Channel<std::uint64_t>& up = *lines_.emplace_back(std::make_unique<Channel<std::uint64_t>>());
      caches_.push_back(std::make_unique<ShapeCache>(
          config_.memory, std::vector<ShapeCache::Client>(clients.begin() + static_cast<std::ptrdiff_t>(first), clients.begin() + static_cast<std::ptrdiff_t>(last)), down, up));
      memory_clients.push_back({&down, &up});
    }
    memory_ = std::make_unique<Memory>(config_.memory, std::move(memory_clients));
  }

  /// The least latency of any channel.
  Cycle lookahead() const {
    return std::min({static_cast<Cycle>(config_.topology.link.latency_cycles), control_latency(config_),
                     ShapeCache::request_latency(config_.memory), ShapeCache::answer_latency(config_.memory),
                     Memory::request_latency(config_.memory), Memory::answer_latency(config_.memory)});
  }

  /// Neighbours go to the same thread, and each cache to the thread of its resources; shading and memory to the last.
  std::vector<std::vector<Agent*>> share_out() const {
    const std::size_t threads = std::clamp<std::size_t>(options_.threads, 1, tiles_.size());
    std::vector<std::vector<Agent*>> parts(threads);
    for (std::size_t r = 0; r < tiles_.size(); ++r) parts[r * threads / tiles_.size()].push_back(tiles_[r].get());
    for (std::size_t c = 0; c < caches_.size(); ++c) parts[c * threads / caches_.size()].push_back(caches_[c].get());
    parts.back().push_back(memory_.get());
    parts.back().push_back(shading_.get());
    return parts;
  }

  void check_at_rest() const {
    std::string waiting = shading_->describe();
    for (const auto& tile : tiles_)
      if (const std::string text = tile->describe(); !text.empty()) waiting += "\n  " + text;
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
    c.memory_lines = memory_->lines();
    c.memory_busy = memory_->busy();
    steady(c);
    for (const auto& tile : tiles_) {
      tile->close(end);
      if (options_.statistics) out.resources.push_back(tile->statistics());
      out.collections.push_back(tile->resource().collections().statistics());
      TileResult& t = c.tiles.emplace_back();
      t.states = tile->clock().times();
      t.box.busy = tile->tester().box.busy();
      t.triangle.busy = tile->tester().triangle.busy();
      t.transform.busy = tile->tester().transform.busy();
      t.handler.busy = tile->handler_busy();
      c.hops += tile->hops();
    }
    const std::vector<Topology::Wire>& wires = machine_.topology.wires();
    std::vector<std::size_t> exits(tiles_.size());
    for (const Topology::Wire& wire : wires) {
      const OutPort& port = tiles_[wire.from.value]->out()[exits[wire.from.value]++];
      c.links.push_back({wire.from.value, wire.to.value, {port.busy(), port.stalled()}});
      LinkStatistics s;
      s.packets = port.packets();
      out.links.push_back({wire.from, wire.to, static_cast<std::size_t>(config_.topology.link.depth), s});
    }
    for (const auto& cache : caches_) {
      const ShapeCache::Statistics& s = cache->statistics();
      c.caches.push_back({s.requests, s.lines, s.hits, s.merged, s.misses});
    }
    return out;
  }

  void steady(CycleResult& c) const {
    const std::vector<ShadingAgent::Milestone>& m = shading_->milestones();
    const std::uint64_t all = shading_->completed();
    const auto first = std::find_if(m.begin(), m.end(), [&](const auto& x) { return 4 * x.completed >= all; });
    const auto last = std::find_if(first, m.end(), [&](const auto& x) { return 4 * x.completed >= 3 * all; });
    if (last == m.end()) return;
    c.steady_cycles = last->at - first->at;
    c.steady_rays = last->completed - first->completed;
  }

  const Config& config_;
  const RunOptions& options_;
  CycleMachine machine_;
  std::vector<std::unique_ptr<Wire>> wires_;   // as the topology's
  std::vector<std::unique_ptr<Channel<NewRays>>> new_rays_;
  std::vector<std::unique_ptr<Channel<CompletedRays>>> completed_;
  std::vector<std::unique_ptr<Channel<FetchRequest>>> fetches_;
  std::vector<std::unique_ptr<Channel<FetchAnswer>>> answers_;
  std::vector<std::unique_ptr<Channel<std::uint64_t>>> lines_;
  std::vector<std::unique_ptr<Tile>> tiles_;
  std::vector<std::unique_ptr<ShapeCache>> caches_;
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
