#include "ringbus/cycle/cycle_engine.h"

#include <algorithm>
#include <chrono>
#include <limits>

#include "core/system/error.h"
#include "ringbus/cycle/progress_log.h"
#include "ringbus/cycle/shapes/shape_buffer.h"
#include "ringbus/cycle/wiring/byte_ledger.h"
#include "ringbus/cycle/wiring/machine_energy.h"
#include "ringbus/cycle/wiring/machine_series.h"
#include "ringbus/cycle/wiring/simulated_machine.h"
#include "ringbus/time/windows.h"

namespace carousel::ringbus {

namespace cycle {

namespace {

/// Runs a simulated machine to its end and collects its counts.
class CycleRun final : public CycleSimulation {
 public:
  CycleRun(const Config& config, const accel::Accel& accel, float scene_size, Workload& workload,
           const RunOptions& options)
      : config_(config),
        options_(options),
        machine_(config, accel, scene_size, workload, options.statistics,
                 {options.trace, most_samples(options.samples, series_counters(config.topology)), options.timeline,
                  options.ray, options.memory, options.ray_times, options.heat}),
        parts_(machine_.share_out(options.threads)),
        wakeups_(parts_) {
    machine_.warm(options.warm);
    machine_.connect(wakeups_);
    if (options.meter != nullptr)
      options.meter->begin(machine_.channels().rows(), most_samples(options.samples, series_counters(config.topology)));
  }

  bool run_until(std::uint64_t completed) override {
    const auto start = std::chrono::steady_clock::now();
    auto last_report = start;
    stopped_ = false;
    const ClockRatio to_fastest = machine_.network().clocks().to_fastest(0);
    const auto keep_running = [&](Cycle reached) {
      const Cycle at = to_fastest.before(reached);
      stopped_ = options_.stop.stop_requested() || machine_.shading().completed() >= completed;
      note_progress(at, stopped_);
      if (machine_.recorder() != nullptr) machine_.recorder()->limit();
      const auto now = std::chrono::steady_clock::now();
      if (options_.progress && now - last_report > std::chrono::milliseconds(200)) {
        last_report = now;
        options_.progress(machine_.shading().completed());
      }
      return !stopped_;
    };
    if (options_.meter == nullptr)
      run_windows(parts_, wakeups_, machine_.lookahead(), sharing(), keep_running);
    else
      run_metered(keep_running, *options_.meter);
    wall_ += std::chrono::steady_clock::now() - start;
    if (!stopped_) check_at_rest();
    return !stopped_;
  }

  const std::vector<ProgressSample>& progress() const override { return log_.samples(); }

  RunResult result() override {
    RunResult out = result(last_event() + 1, !stopped_);
    out.complete = !stopped_;
    out.wall_seconds = wall_.count();
    out.threads = parts_.size();
    return out;
  }

 private:
  /// A number of threads that is asked for is taken at its word.
  Sharing sharing() const { return config_.engine.threads ? Sharing::kAlways : Sharing::kWhenFaster; }

  /// A cycle of the resources begins with the last cycle of the fastest clock that is not after it.
  void run_metered(const std::function<bool(Cycle)>& keep_running, EnergyMeter& meter) {
    const ClockRatio to_fastest = machine_.network().clocks().to_fastest(0);
    const auto look = [&](Cycle) {
      read_energy(machine_, energy_);
      meter.read(energy_);
      return to_fastest.floor_to_network(meter.next());
    };
    run_windows(parts_, wakeups_, machine_.lookahead(), sharing(), keep_running, look,
                to_fastest.floor_to_network(meter.next()));
  }

  /// The last cycle in which anything was done. Caches, memory, bus and bridges only pass on things that arrive later.
  Cycle last_event() const {
    Cycle last = machine_.shading().last_event();
    for (const auto& tile : machine_.resources()) last = std::max(last, tile->last_event());
    return last;
  }

  void check_at_rest() const {
    const std::string waits = machine_.describe_waits();
    if (!machine_.shading().done() || !waits.empty())
      throw SimulationError("nothing moves any more; who waits for whom:\n  " + waits);
  }

  static void check_ledger(const TileResult& tile, Cycle end) {
    Cycle sum = 0;
    for (const Cycle state : tile.states) sum += state;
    constexpr auto kTesting = static_cast<std::size_t>(TileState::kTesting);
    bool fits =
        sum == end && tile.dispatch.busy <= end && tile.testing.any + tile.testing.latency <= tile.states[kTesting];
    const auto check = [&](const BankUse& use) {
      Cycle busy = 0;
      fits &= use.busy_in[kTesting] <= tile.testing.any;
      for (std::size_t state = 0; state < kTileStates; ++state) {
        fits &= use.busy_in[state] <= tile.states[state];
        busy += use.busy_in[state];
      }
      fits &= busy == use.busy;
    };
    for (const auto [kind, use] : tile.units) check(use);
    check(tile.ray_reads);
    check(tile.primitive_ray_reads);
    if (!fits) throw SimulationError("the cycles of a resource's parts do not add up to the run");
  }

  /// The stages that a ray spends in its slot, against the times of the slots.
  static void check_ray_times(const std::vector<RayTimeRow>& rows, std::uint64_t residence) {
    std::uint64_t sum = 0;
    for (const RayTimeRow& row : rows)
      for (auto stage = RayStage::kLoad; stage <= RayStage::kReturn; stage = RayStage(std::uint8_t(stage) + 1))
        sum += row.stages[stage];
    if (sum != residence) throw SimulationError("the stages of the rays' time do not add up to their time in slots");
  }

  std::optional<IdsAtOnce> ids_at_once() const {
    if (!machine_.shared().topology.has_packets()) return std::nullopt;
    IdsAtOnce out;
    std::vector<std::uint64_t> sums;
    for (const auto& tile : machine_.resources()) {
      // All resources were looked at over the same cycles.
      const IdCensus& census = *tile->census();
      sums.resize(census.samples().size());
      for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += census.samples()[i];
      out.interval = census.interval();
    }
    for (const std::uint64_t sum : sums) out.most = std::max(out.most, sum);
    return out;
  }

  RunResult result(Cycle end, bool complete) {
    RunResult out;
    out.rays_emitted = machine_.shading().emitted();
    out.rays_completed = machine_.shading().completed();
    out.slots_used = machine_.shared().slots_used();
    out.slot_waits = machine_.shared().slot_waits();
    CycleResult& c = out.cycle.emplace();
    c.cycles = end;
    c.shading = machine_.shading().counts();
    c.residence = machine_.shading().residence();
    for (const auto& pool : machine_.shading().pools()) c.pools.push_back({pool->completed(), pool->busy()});
    if (const RayTimes* times = machine_.ray_times(); times != nullptr && complete) {
      c.ray_times = times->rows();
      if (kChecked) check_ray_times(*c.ray_times, c.residence.sum());
    }
    out.nearest = machine_.shared().nearest();
    const ResourceLoss& loss = machine_.shading().loss();
    out.rays_restarted = loss.rays_restarted();
    out.paths_restarted = loss.paths_restarted();
    if (loss.times() && loss.times()->noticed > 0) c.stop = loss.times();
    for (const auto& tile : machine_.resources()) out.packets_discarded += tile->packets_discarded();
    c.memory = machine_.memory().counts();
    c.first_reads = first_reads();
    c.uses = uses();
    c.progress = log_.samples();
    c.all_begun = all_begun_;
    std::vector<const Trace*> traces{&machine_.shading().trace()};
    for (const auto& tile : machine_.resources()) traces.push_back(&tile->trace());
    c.epochs = combine(traces);
    c.steps = merge_steps(traces);
    machine_.close(end);
    c.dram = machine_.memory().dram_use(end);
    if (machine_.recorder() != nullptr) {
      out.timeline = machine_.recorder()->timeline(end);
      out.facts = machine_.recorder()->facts();
    }
    if (options_.samples > 0) out.series = machine_series(machine_);
    for (const auto& tile : machine_.resources()) {
      if (options_.statistics) out.resources.push_back(tile->statistics());
      out.collections.push_back(tile->collections());
      c.tiles.push_back(tile->result());
      if (kChecked) check_ledger(c.tiles.back(), end);
    }
    c.ids = ids_at_once();
    machine_.for_each_link([&](const Topology::Wire& wire, std::size_t port_number) {
      const OutPort& port = machine_.out_of(wire.from)[port_number];
      c.hops += port.packets();
      c.links.push_back(machine_.use_of_link(c.links.size(), port_number, end));
      LinkStatistics s;
      s.packets = port.packets();
      out.links.push_back({wire.from, wire.to, static_cast<std::size_t>(wire.depth), s, {}, port.faults()});
    });
    add_parcels(end, out);
    add_rings(end, out);
    c.memories = machine_.memory().memories().size();
    if (const RayData* data = machine_.shading().ray_data()) c.ray_data = data->bytes();
    if (config_.bvh.leaves == BvhConfig::Leaves::kStrips) c.strips = machine_.shapes().strips().counts();
    if (const accel::PackedLeaves* blocks = machine_.shapes().blocks()) c.blocks = blocks->counts();
    c.structure_bytes = machine_.shapes().size_bytes();
    if (complete) c.drain = machine_.drain(end);
    for (const auto& cache : machine_.memory().caches()) {
      c.caches.push_back(cache->statistics());
      c.cached_lines.push_back(cache->lines());
      c.recent_lines.push_back(cache->recent_lines());
      if (!machine_.parts().ahead_at(c.caches.size() - 1).empty()) c.fetched_ahead.push_back(cache->ahead());
    }
    for (const auto& resource : machine_.resources()) c.buffered.push_back(resource->shape_buffer().kept());
    for (const auto& cache : machine_.memory().own_caches()) {
      (c.own_caches ? *c.own_caches : c.own_caches.emplace()) += cache->statistics();
      c.own_recent.push_back(cache->recent_lines());
    }
    c.parts = machine_.parts().counts();
    c.bytes = byte_ledger(machine_);
    if (options_.meter != nullptr) {
      read_energy(machine_, energy_);
      options_.meter->close(end, energy_);
    }
    if (kChecked && complete) {
      check_byte_ledger(c.bytes);
      check_lines(machine_, c.bytes, config_.memory);
    }
    return out;
  }

  /// The links between the stops of rings follow all others.
  void add_rings(Cycle end, RunResult& out) const {
    CycleResult& c = *out.cycle;
    for (const RingHub* ring : machine_.network().rings()) {
      (c.stops ? *c.stops : c.stops.emplace()) += ring->docks().fabric().use();
      ring->for_each_link([&](const config::Graph::Link& drawn, const RingLinks::Use& use) {
        const Cycle busy = machine_.network().clocks().from_core(drawn.mhz).before(use.busy);
        const std::uint64_t bytes = use.busy * static_cast<std::uint64_t>(drawn.bytes_per_cycle);
        c.links.push_back({drawn.from, drawn.to, {std::min(busy, end), 0}, {}, bytes, drawn.mhz});
        LinkStatistics s;
        s.packets = use.packets;
        out.links.push_back({ResourceId(drawn.from), ResourceId(drawn.to), 0, s, {}, {}});
      });
    }
  }

  /// What links carried beside packets: it adds to the links that packets use, and the others follow these.
  void add_parcels(Cycle end, RunResult& out) const {
    if (machine_.parcels() == nullptr) return;
    CycleResult& c = *out.cycle;
    const ParcelPlan& plan = machine_.parcels()->plan();
    for (std::size_t i = 0; i < plan.links.size(); ++i) {
      const config::Graph::Link& drawn = plan.drawn(plan.links[i]);
      const LinkTime& time = machine_.parcels()->time_of(i);
      if (plan.links[i].wire == ParcelPlan::kNone) {
        c.links.push_back({drawn.from, drawn.to, {time.busy(end), 0}, time.queue(), time.bytes(), drawn.mhz});
        LinkStatistics s;
        s.packets = time.parcels();
        out.links.push_back({ResourceId(drawn.from), ResourceId(drawn.to), 0, s, {}, {}});
        continue;
      }
      LinkUse& link = c.links[plan.links[i].wire];
      link.use.busy = time.busy(end);
      link.use.stalled = std::min(link.use.stalled, end - link.use.busy);
      link.queue.packet_cycles += time.queue().packet_cycles;
      link.queue.most += time.queue().most;
      link.bytes += time.bytes();
      out.links[plan.links[i].wire].statistics.packets += time.parcels();
    }
  }

  std::uint64_t first_reads() const {
    std::uint64_t sum = 0;
    for (const auto& memory : machine_.memory().memories()) sum += memory->first_reads();
    return sum;
  }

  /// `last`: the run ends here.
  void note_progress(Cycle at, bool last) {
    const ShadingAgent& shading = machine_.shading();
    const bool begun = shading.all_begun() && !all_begun_, wanted = last || log_.wants(shading.completed());
    if (!begun && !wanted) return;
    ProgressSample sample{at, shading.completed(), {}, machine_.memory().counts().lines, first_reads()};
    for (const ClassUse& use : uses()) sample.busy.push_back(use.busy);
    if (begun) all_begun_ = sample;
    if (wanted) log_.add(std::move(sample));
  }

  /// The classes of parts that the machine has, in a fixed order, and their use so far.
  std::vector<ClassUse> uses() const {
    PerUnit<ClassUse> units{};
    ClassUse reads{"ray_reads"}, dispatch{"dispatch"}, l2{"l2_port"}, l1{"l1_port"}, memory{"memory_bandwidth"},
        shading{"shading"};
    for (const auto& tile : machine_.resources()) {
      const ResourceAgent::Work own = tile->work();
      for (const auto [kind, use] : units) use.count(1, own.units[kind]);
      reads.count(config_.rays.banks > 0 ? 2 : 1, own.ray_reads);
      dispatch.count(1, own.dispatch);
    }
    for (const auto& cache : machine_.memory().caches())
      l2.count(static_cast<double>(config_.memory.l2_banks), cache->statistics().port_busy);
    for (const auto& cache : machine_.memory().own_caches()) l1.count(1, cache->statistics().port_busy);
    for (const auto& one : machine_.memory().memories()) memory.count(1, one->counts().busy);
    const std::vector<std::int64_t> workers = pool_workers(config_);
    for (std::size_t i = 0; i < workers.size(); ++i)
      shading.count(static_cast<double>(workers[i]), machine_.shading().pools()[i]->busy());
    // Packet processes that serve resources have no units, rays and caches.
    const double testing = dispatch.parts - static_cast<double>(managers_of(config_.topology));
    reads.parts = config_.rays.banks > 0 ? 2 * testing : testing;
    l1.parts = testing;
    std::vector<ClassUse> out;
    for (const auto [kind, use] : units) out.push_back({unit_row(kind).work, testing, use.busy, use.most});
    out.insert(out.end(), {reads, dispatch, link_use(), l2});
    if (!machine_.memory().own_caches().empty()) out.push_back(l1);
    out.insert(out.end(), {memory, shading});
    return out;
  }

  /// The links are as many media side by side; a bus is one, to which the links of the resources lead: what one of them
  /// brings crosses it once, whoever hears it.
  ClassUse link_use() const {
    const bool bus = is_bus(config_.topology);
    ClassUse out{"link_bandwidth", bus ? 1.0 : static_cast<double>(machine_.shared().topology.wires().size()), 0};
    std::size_t number = 0;
    machine_.for_each_link([&](const Topology::Wire& wire, std::size_t port) {
      const std::size_t link = number++;
      if (!bus || wire.from.value < machine_.resources().size()) out.count(0, machine_.busy_of_link(link, port));
    });
    if (machine_.parcels() == nullptr) return out;
    const ParcelPlan& plan = machine_.parcels()->plan();
    for (std::size_t i = 0; i < plan.links.size(); ++i) {
      const std::uint32_t shared = plan.links[i].wire;
      out.count(shared == ParcelPlan::kNone ? 1 : 0, machine_.parcels()->time_of(i).busy());
      if (shared != ParcelPlan::kNone)  // which has the packets too
        out.busy -= machine_.busy_of_link(shared, machine_.shared().topology.out_port_of(shared));
    }
    return out;
  }

  const Config& config_;
  const RunOptions& options_;
  SimulatedMachine machine_;
  std::vector<std::vector<Agent*>> parts_;
  WakeupTable wakeups_;
  bool stopped_ = false;
  std::chrono::duration<double> wall_{0};
  ProgressLog log_;
  EnergyEvents energy_;
  std::optional<ProgressSample> all_begun_;
};

}  // namespace

}  // namespace cycle

RunResult run_cycle(const Config& config, const accel::Accel& accel, float scene_size, Workload& workload,
                    const RunOptions& options) {
  cycle::CycleRun run(config, accel, scene_size, workload, options);
  run.run_until(std::numeric_limits<std::uint64_t>::max());
  return run.result();
}

std::unique_ptr<CycleSimulation> begin_cycle(const Config& config, const accel::Accel& accel, float scene_size,
                                             Workload& workload, const RunOptions& options) {
  return std::make_unique<cycle::CycleRun>(config, accel, scene_size, workload, options);
}

}  // namespace carousel::ringbus
