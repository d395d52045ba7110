#include "ringbus/native/native_engine.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "core/system/error.h"
#include "core/system/process_memory.h"
#include "ringbus/faults/unfinished_rays.h"
#include "ringbus/native/native_machine.h"
#include "ringbus/native/native_port.h"
#include "ringbus/native/native_series.h"
#include "ringbus/native/shader_worker.h"
#include "ringbus/ranks/gather_result.h"
#include "ringbus/schedule/schedule.h"

namespace carousel::ringbus {

namespace {

/// One run of the engine: shares ports and workers out over threads, and finds out how the run ends.
class NativeRun {
 public:
  NativeRun(const Config& config, const accel::Accel& accel, float scene_size, Workload& workload,
            const RunOptions& options, const LinkMaker& own_links)
      : options_(options),
        own_links_(own_links),
        config_(config),
        accel_(accel),
        scene_size_(scene_size),
        workload_(workload),
        series_(options.samples, config) {
    for (std::int64_t r = 0; r < config.topology.resources; ++r)
      sinks_.push_back(options.statistics ? std::make_unique<StatisticsSink>() : nullptr);
    if (config.faults.resource.kind == FaultsConfig::Resource::Kind::kStop)
      ledger_ = std::make_unique<OutstandingRays>();
    const std::int64_t resources =
        options.transport == nullptr
            ? config.topology.resources
            : RankShare(options.transport->rank(), options.transport->ranks(), config.topology.resources).arc_size();
    // Agents of a schedule share one thread, so that each resource and each worker may be one.
    const std::int64_t workers = shader_workers(config), agents = resources + workers;
    const std::int64_t most = Schedule::current() == nullptr ? std::max(resources, workers) : agents;
    threads_ = std::clamp<std::size_t>(options.threads, 1, static_cast<std::size_t>(most));
    if (Schedule::current() != nullptr) first_worker_ = static_cast<std::size_t>(resources) % threads_;
    build();
    progress_ = std::make_unique<Progress[]>(threads_);
  }

  RunResult run() {
    if (recorder_) recorder_->start(other_ranks());
    start_ = Clock::now();
    if (machine_->gate) machine_->gate->start();
    for (;;) {
      run_threads();
      if (machine_->gate) machine_->gate->part(error_, stuck_ ? describe_stuck() : "");
      if (error_) std::rethrow_exception(error_);
      if (stuck_) throw SimulationError(describe_stuck());
      if (!excluded_ || given_up_ || options_.stop.stop_requested()) break;
      restart();
    }
    const std::chrono::duration<double> wall = Clock::now() - start_;
    look();
    // A run that is interrupted when all rays have been shaded may leave packets on their way.
    const bool complete = at_rest() && !(machine_->gate && machine_->gate->stopped());
    if (complete) check_drained();
    RunResult out = result(complete, wall.count());
    if (machine_->gate) gather_result(*options_.transport, machine_->shared.share, out);
    if (recorder_) out.timeline = recorder_->timeline(other_ranks());
    return out;
  }

 private:
  struct alignas(128) Progress {
    std::atomic<std::uint64_t> steps{0};  // that moved something
    std::chrono::nanoseconds waited{0};   // among ranks: without anything to do
  };

  using Clock = ScheduleClock;
  // A resource is given up when it has taken no step for so long while its thread has.
  static constexpr std::chrono::milliseconds kSilence{100};

  /// Makes the machine anew, with nothing in it, and the ports and workers that threads step.
  void build() {
    ports_.clear();
    workers_.clear();
    machine_ = std::make_unique<NativeMachine>(config_, accel_, scene_size_, own_links_, options_.transport, threads_);
    const NativePortSettings settings{resource_settings(config_, scene_size_), config_.faults,
                                      config_.engine.clock_mhz};
    const RankShare& share = machine_->shared.share;
    for (std::uint32_t r = 0; r < sinks_.size(); ++r)
      if (share.here(ResourceId(r)))
        ports_.push_back(std::make_unique<NativePort>(ResourceId(r), *machine_, settings, sinks_[r].get()));
    if (!recorder_ && (options_.timeline.most > 0 || options_.ray != nullptr))
      recorder_ = std::make_unique<NativeRecorder>(config_, share, machine_->shared.packets.size(), options_.timeline,
                                                   options_.ray);
    if (recorder_ && machine_->gate) machine_->gate->record(*recorder_);
    for (std::size_t r = 0; recorder_ && r < ports_.size(); ++r) ports_[r]->record(*recorder_);
    for (const auto& link : machine_->links) link->count(options_.statistics && options_.link_statistics);
    const auto slots = static_cast<std::int64_t>(machine_->shared.control.free_slots());  // that this rank fills
    for (std::uint32_t w = 0; w < static_cast<std::uint32_t>(shader_workers(config_)); ++w)
      workers_.push_back(std::make_unique<ShaderWorker>(WorkerId(w), machine_->shared.control, machine_->completed,
                                                        workload_, count_, slots, shader_workers(config_),
                                                        ledger_.get()));
  }

  void run_threads() {
    ended_ = 0;
    end_ = false;
    if (Schedule* const schedule = Schedule::current(); schedule != nullptr) {
      for (std::size_t t = 0; t < threads_; ++t) schedule->start([this, t] { work(t); });
      return watch();
    }
    std::vector<std::jthread> threads;
    try {
      for (std::size_t t = 0; t < threads_; ++t) threads.emplace_back([this, t] { work(t); });
    } catch (...) {  // no further thread can be started: those that run have to end
      end_.store(true, std::memory_order_release);
      throw;
    }
    watch();
  }

  /// Begins again without the resource that has stopped. All work that was under way is gone; every ray that had not
  /// been handed over to shading starts anew at the resources that are left. The port of the stopped resource goes on
  /// forwarding.
  void restart() {
    std::vector<HitBatch> handed_over;
    while (HitBatch* const batch = machine_->completed.try_pop()) handed_over.push_back(std::move(*batch));
    const RayBatch rays = ledger_->open(handed_over);
    if (!config_.faults.resource.recover && !rays.empty())
      throw SimulationError(unfinished_rays(*excluded_, rays, count_.completed.load()));
    schedule_point();
    for (const auto& port : ports_) packets_discarded_ += port->resource().packets_in_flight();
    series_.carry(ports_);
    carry_links();
    completed_ += machine_->completed.use();
    groups_ += machine_->shared.control.groups_sent();
    slots_used_ += machine_->shared.control.slots_used();
    slot_waits_ += machine_->shared.control.slot_waits();
    build();
    schedule_point();
    for (HitBatch& batch : handed_over) {
      HitBatch* const place = machine_->completed.try_take();
      place->swap(batch);
      machine_->completed.push(place, place->size());
    }
    machine_->shared.control.exclude(*excluded_);
    for (const auto& port : ports_) port->exclude(*excluded_);
    ports_[excluded_->value]->stop();
    given_up_ = true;
    rays_restarted_ += rays.size();
    paths_restarted_ += OutstandingRays::paths_of(rays);
    recovery_seconds_ = std::chrono::duration<double>(Clock::now() - last_beat_).count();
    schedule_point();
    if (!rays.empty()) machine_->shared.control.submit(rays);
    schedule_point();
  }

  /// Keeps the counts of the links, which are about to be made anew.
  void carry_links() {
    faults_before_.resize(machine_->links.size());
    for (std::size_t i = 0; i < machine_->links.size(); ++i) faults_before_[i] += machine_->links[i]->faults();
  }

  /// Tells whether the resource that may stop is silent, and sets `last_beat_` to the time when it last was not.
  bool silent() {
    if (!ledger_ || given_up_) return false;
    const ResourceId id(static_cast<std::uint32_t>(config_.faults.resource.number));
    const std::uint64_t beats = ports_[id.value]->beats();
    if (std::exchange(beats_, beats) != beats || last_beat_ == Clock::time_point{}) last_beat_ = Clock::now();
    // Time in which its thread did not run does not count.
    const std::uint64_t turns = turns_.load(std::memory_order_relaxed);
    if (std::exchange(turns_seen_, turns) == turns) last_beat_ = std::max(last_beat_, Clock::now() - kSilence / 2);
    if (Clock::now() - last_beat_ < kSilence) return false;
    excluded_ = id;
    return true;
  }

  void work(std::size_t thread) {
    try {
      // With other ranks on the same cores, as in tests, a yield is over only when all of these have had their turn; a
      // thread that has slept comes first.
      const int patience = machine_->gate ? 16 : 256;
      int idle = 0;
      Clock::time_point idle_since;
      const auto end_wait = [&] {
        if (idle > 0 && machine_->gate) progress_[thread].waited += Clock::now() - idle_since;
        idle = 0;
      };
      // Acquire: pairs with the release that asks everyone to end.
      while (!end_.load(std::memory_order_acquire)) {
        bool moved = false, rests = false;
        // Relaxed: the watcher only wants to see it change.
        if (ledger_ && thread == static_cast<std::size_t>(config_.faults.resource.number) % threads_)
          turns_.store(turns_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
        for (std::size_t r = thread; r < ports_.size(); r += threads_) {
          moved |= ports_[r]->step();
          rests |= ports_[r]->rests();
        }
        for (std::size_t w = (thread + threads_ - first_worker_) % threads_; w < workers_.size(); w += threads_)
          moved |= workers_[w]->step();
        if (machine_->gate && !moved) machine_->gate->found_nothing();
        if (machine_->gate && thread == 0) moved |= machine_->gate->step(at_rest());
        // Relaxed: the watcher only wants to see it change. A rest that was asked for ends by itself, so it is no halt.
        if (moved || rests) progress_[thread].steps.fetch_add(1, std::memory_order_relaxed);
        if (moved) {
          end_wait();
        } else if (machine_->gate ? machine_->gate->ended() : at_rest()) {
          break;
        }
        schedule_point();
        if (moved || Schedule::current() != nullptr) continue;
        if (idle == 0 && machine_->gate) idle_since = Clock::now();
        if (++idle < patience) {
          // Two threads on one core must not wait out each other's time slices.
          std::this_thread::yield();
        } else {
          std::this_thread::sleep_for(std::chrono::microseconds(50));
        }
      }
      end_wait();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      end_.store(true, std::memory_order_release);
    }
    const std::lock_guard lock(mutex_);
    ++ended_;
    ended_changed_.notify_all();
  }

  bool at_rest() const { return count_.done() && packets_out() == 0; }
  // When the last ray has been shaded, packets may still be on their way to their owners, through resources of any
  // thread. From then on none is sent out any more, so a sum of zero stays zero.
  std::uint64_t packets_out() const {
    std::uint64_t out = 0;
    for (const auto& port : ports_) out += port->packets_out();
    return out;
  }

  /// Runs on the calling thread: reports progress, and looks for the request to stop and for a run that is stuck.
  void watch() {
    std::uint64_t last = 0;
    Clock::time_point last_change = Clock::now();
    std::unique_lock lock(mutex_);
    const std::chrono::milliseconds interval(ledger_ ? 10 : 100);
    const auto pause = series_.on() ? std::min(interval, NativeSeries::kPollInterval) : interval;
    Clock::time_point next_check = Clock::now() + interval;
    while (!schedule_wait(ended_changed_, lock, pause, [this] { return ended_ == threads_; })) {
      look();
      if (Clock::now() < next_check) continue;
      next_check = Clock::now() + interval;
      if (options_.progress) options_.progress(count_.completed.load(std::memory_order_relaxed));
      std::uint64_t steps = 0;
      for (std::size_t t = 0; t < threads_; ++t) steps += progress_[t].steps.load(std::memory_order_relaxed);
      if (steps != last || (machine_->gate && at_rest())) {  // with nothing to do it waits for other ranks
        last = steps;
        last_change = Clock::now();
      } else if (Clock::now() - last_change > options_.stuck_after) {
        stuck_ = true;
      }
      // Release: pairs with the acquire in work().
      if (stuck_ || silent() || options_.stop.stop_requested()) end_.store(true, std::memory_order_release);
    }
  }

  /// The way to them; null if there are none.
  Transport* other_ranks() const { return machine_->gate ? options_.transport : nullptr; }
  void look() { series_.look(Clock::now() - start_, count_, machine_->shared.control, ports_); }
  std::string describe_stuck() const {
    std::string text =
        fmt::format("no progress for {} ms with {} rays outstanding; who waits for whom:", options_.stuck_after.count(),
                    count_.outstanding.load());
    for (const auto& port : ports_) text += "\n  " + port->describe();
    if (machine_->gate) text += "\n  " + machine_->gate->describe();
    return text;
  }

  void check_drained() const {
    if (count_.emitted != count_.completed)
      throw SimulationError(
          fmt::format("{} rays emitted, {} completed", count_.emitted.load(), count_.completed.load()));
    for (const auto& port : ports_)
      if (!port->drained()) throw SimulationError("something was left behind: " + port->describe());
  }

  RunResult result(bool complete, double wall_seconds) {
    RunResult out;
    out.complete = complete;
    out.rays_emitted = count_.emitted;
    out.rays_completed = count_.completed;
    out.rays_restarted = rays_restarted_;
    out.paths_restarted = paths_restarted_;
    out.packets_discarded = packets_discarded_;
    for (const auto& port : ports_) out.packets_discarded += port->packets_discarded();
    out.recovery_seconds = recovery_seconds_;
    out.wall_seconds = wall_seconds;
    out.threads = threads_;
    out.slots_used = slots_used_ + machine_->shared.control.slots_used();
    out.slot_waits = slot_waits_ + machine_->shared.control.slot_waits();
    (out.completed = completed_) += machine_->completed.use();
    (out.groups = groups_) += machine_->shared.control.groups_sent();
    for (const auto& sink : sinks_)
      if (sink) out.resources.push_back(sink->statistics());
    out.collections.resize(sinks_.size());
    for (const auto& port : ports_)
      out.collections[port->resource().id().value] = port->resource().collections().statistics();
    for (const auto& link : machine_->links)
      out.links.push_back(
          {link->from(), link->to(), link->capacity(), link->statistics(), link->series(), link->faults()});
    for (std::size_t i = 0; i < faults_before_.size(); ++i) out.links[i].faults += faults_before_[i];
    out.start = start_;
    if (machine_->gate) {
      out.ranks.resize(machine_->shared.share.ranks());
      RankResult& own = out.ranks[machine_->shared.share.rank()];
      own.to = machine_->gate->counts();
      std::chrono::duration<double> waited{0};
      for (std::size_t t = 0; t < threads_; ++t) waited += progress_[t].waited;
      own.waiting = std::min(1.0, waited.count() / (wall_seconds * static_cast<double>(threads_)));
      const ShapeTravel* const shapes = machine_->gate->shapes();
      own.memory = {options_.scene_bytes, accel_.size_bytes(), shapes != nullptr ? shapes->guest_bytes() : 0,
                    peak_memory_bytes()};
    }
    if (series_.on()) out.series = series_.finish();
    if (recorder_) out.facts = recorder_->facts();
    return out;
  }

  const RunOptions& options_;
  const LinkMaker own_links_;  // empty: links as configured
  const Config& config_;
  const accel::Accel& accel_;
  float scene_size_;
  Workload& workload_;
  std::unique_ptr<NativeMachine> machine_;
  RayCount count_;
  std::unique_ptr<OutstandingRays> ledger_;  // where a resource may stop
  std::atomic<std::uint64_t> turns_{0};      // turns of the thread that plays that resource
  std::uint64_t turns_seen_ = 0, beats_ = 0;
  Clock::time_point last_beat_{};
  std::optional<ResourceId> excluded_;  // it has stopped
  bool given_up_ = false;               // and the others go on without it
  std::uint64_t rays_restarted_ = 0, paths_restarted_ = 0, packets_discarded_ = 0;
  std::uint64_t slots_used_ = 0, slot_waits_ = 0;  // before the machine was built anew
  QueueUse completed_, groups_;                    // likewise
  std::vector<LinkFaultCounts> faults_before_;     // likewise, by link
  double recovery_seconds_ = 0;
  std::vector<std::unique_ptr<StatisticsSink>> sinks_;
  std::vector<std::unique_ptr<NativePort>> ports_;
  std::vector<std::unique_ptr<ShaderWorker>> workers_;
  std::size_t threads_;
  std::size_t first_worker_ = 0;  // the thread that plays worker 0
  Clock::time_point start_{};
  NativeSeries series_;
  std::unique_ptr<NativeRecorder> recorder_;  // null: nothing is recorded
  std::unique_ptr<Progress[]> progress_;
  std::atomic<bool> end_{false};
  bool stuck_ = false;
  std::mutex mutex_;  // guards ended_ and error_
  std::condition_variable ended_changed_;
  std::size_t ended_ = 0;
  std::exception_ptr error_;
};

}  // namespace

RunResult run_native(const Config& config, const accel::Accel& accel, float scene_size, Workload& workload,
                     const RunOptions& options) {
  return NativeRun(config, accel, scene_size, workload, options, {}).run();
}

RunResult run_native_on(const LinkMaker& links, const Config& config, const accel::Accel& accel, float scene_size,
                        Workload& workload, const RunOptions& options) {
  return NativeRun(config, accel, scene_size, workload, options, links).run();
}

}  // namespace carousel::ringbus
