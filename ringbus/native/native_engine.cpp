#include "ringbus/native/native_engine.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "core/system/error.h"
#include "core/system/process_memory.h"
#include "ringbus/faults/unfinished_rays.h"
#include "ringbus/native/counts_before_restart.h"
#include "ringbus/native/heartbeat_monitor.h"
#include "ringbus/native/native_parts.h"
#include "ringbus/native/native_series.h"
#include "ringbus/native/worker_threads.h"
#include "ringbus/ranks/gather_result.h"
#include "ringbus/schedule/schedule.h"

namespace carousel::ringbus {

namespace {

/// One run of the engine: its threads step the machine, the calling thread watches them, and a machine of which a
/// resource has stopped is begun again without it.
class NativeRun {
 public:
  NativeRun(const Config& config, const accel::Accel& accel, float scene_size, Workload& workload,
            const RunOptions& options, const LinkMaker& own_links)
      : options_(options),
        config_(config),
        accel_(accel),
        threads_(NativeParts::most_threads(config, options)),
        parts_(config, accel, scene_size, workload, options, own_links, threads_.count()),
        series_(options.samples, config) {}

  RunResult run() {
    if (parts_.recorder() != nullptr) parts_.recorder()->start(other_ranks());
    start_ = Clock::now();
    if (parts_.gate() != nullptr) parts_.gate()->start();
    for (;;) {
      threads_.run([this](std::size_t thread) { work(thread); }, [this] { watch(); });
      if (parts_.gate() != nullptr) parts_.gate()->part(threads_.error(), stuck_ ? describe_stuck() : "");
      if (threads_.error()) std::rethrow_exception(threads_.error());
      if (stuck_) throw SimulationError(describe_stuck());
      if (!excluded_ || given_up_ || options_.stop.stop_requested()) break;
      restart();
    }
    const std::chrono::duration<double> wall = Clock::now() - start_;
    look();
    // A run that is interrupted when all rays have been shaded may leave packets on their way.
    const bool complete = parts_.at_rest() && !(parts_.gate() != nullptr && parts_.gate()->stopped());
    if (complete) parts_.check_drained();
    RunResult out = result(complete, wall.count());
    if (parts_.gate() != nullptr) gather_result(*options_.transport, parts_.machine().shared.share, out);
    if (parts_.recorder() != nullptr) out.timeline = parts_.recorder()->timeline(other_ranks());
    return out;
  }

 private:
  using Clock = ScheduleClock;

  /// Begins again without the resource that has stopped. All work that was under way is gone; every ray that had not
  /// been handed over to shading starts anew at the resources that are left. The port of the stopped resource goes on
  /// forwarding.
  void restart() {
    std::vector<HitBatch> handed_over;
    while (HitBatch* const batch = parts_.machine().completed.try_pop()) handed_over.push_back(std::move(*batch));
    const RayBatch rays = parts_.ledger()->open(handed_over);
    if (!config_.faults.resource.recover && !rays.empty())
      throw SimulationError(unfinished_rays(*excluded_, rays, parts_.count().completed.load()));
    schedule_point();
    before_restart_.keep(parts_);
    series_.carry(parts_.ports());
    parts_.build();
    schedule_point();
    NativeMachine& machine = parts_.machine();
    for (HitBatch& batch : handed_over) {
      HitBatch* const place = machine.completed.try_take();
      place->swap(batch);
      machine.completed.push(place, place->size());
    }
    machine.shared.control.exclude(*excluded_);
    for (const auto& port : parts_.ports()) port->exclude(*excluded_);
    parts_.ports()[excluded_->value]->stop();
    given_up_ = true;
    before_restart_.restart(rays, std::chrono::duration<double>(Clock::now() - heartbeat_.last_beat()).count());
    schedule_point();
    if (!rays.empty()) machine.shared.control.submit(rays);
    schedule_point();
  }

  /// Tells whether the resource that may stop is silent, and takes it for stopped then.
  bool silent() {
    if (parts_.ledger() == nullptr || given_up_) return false;
    const ResourceId id(static_cast<std::uint32_t>(config_.faults.resource.number));
    if (!heartbeat_.silent(parts_.ports()[id.value]->beats())) return false;
    excluded_ = id;
    return true;
  }

  void work(std::size_t thread) {
    RankGate* const gate = parts_.gate();
    // With other ranks on the same cores, as in tests, a yield is over only when all of these have had their turn; a
    // thread that has slept comes first.
    const int patience = gate != nullptr ? 16 : 256;
    const bool plays_stopping = parts_.ledger() != nullptr &&
                                thread == static_cast<std::size_t>(config_.faults.resource.number) % threads_.count();
    int idle = 0;
    Clock::time_point idle_since;
    const auto end_wait = [&] {
      if (idle > 0 && gate != nullptr) threads_.note_waited(thread, Clock::now() - idle_since);
      idle = 0;
    };
    while (!threads_.ending()) {
      if (plays_stopping) heartbeat_.note_turn();
      auto [moved, rests] = parts_.step(thread);
      if (gate != nullptr && !moved) gate->found_nothing();
      if (gate != nullptr && thread == 0) moved |= gate->step(parts_.at_rest());
      // A rest that was asked for ends by itself, so it is no halt.
      if (moved || rests) threads_.note_step(thread);
      if (moved) {
        end_wait();
      } else if (gate != nullptr ? gate->ended() : parts_.at_rest()) {
        break;
      }
      if (!moved) threads_.note_look(thread);
      schedule_point();
      if (moved || Schedule::current() != nullptr) continue;
      if (idle == 0 && gate != nullptr) idle_since = Clock::now();
      if (++idle < patience) {
        // Two threads on one core must not wait out each other's time slices.
        std::this_thread::yield();
      } else {
        std::this_thread::sleep_for(std::chrono::microseconds(50));
      }
    }
    end_wait();
  }

  /// Runs on the calling thread: reports progress, and looks for the request to stop and for a run that is stuck. Time
  /// in which a thread never came to look for work, on a busy host, counts a sixth: that thread may hold what others
  /// wait for.
  void watch() {
    std::uint64_t last = 0;
    Clock::time_point last_look = Clock::now();
    Clock::duration nothing_moved{0};
    const std::chrono::milliseconds interval(parts_.ledger() != nullptr ? 10 : 100);
    const auto pause = series_.on() ? std::min(interval, NativeSeries::kPollInterval) : interval;
    Clock::time_point next_check = Clock::now() + interval;
    threads_.watch(pause, [&] {
      look();
      if (Clock::now() < next_check) return;
      next_check = Clock::now() + interval;
      if (options_.progress) options_.progress(parts_.count().completed.load(std::memory_order_relaxed));
      const Clock::time_point now = Clock::now();
      const bool all_looked = threads_.all_have_looked();
      const std::uint64_t steps = threads_.steps();
      if (steps != last || (parts_.gate() != nullptr && parts_.at_rest())) {  // with nothing to do it waits for others
        last = steps;
        nothing_moved = {};
      } else {
        nothing_moved += all_looked ? now - last_look : (now - last_look) / 6;
        stuck_ |= nothing_moved > options_.stuck_after;  // also if a thread moves something before it ends
      }
      last_look = now;
      if (stuck_ || silent() || options_.stop.stop_requested()) threads_.end();
    });
  }

  /// The way to them; null if there are none.
  Transport* other_ranks() const { return parts_.gate() != nullptr ? options_.transport : nullptr; }
  void look() { series_.look(Clock::now() - start_, parts_.count(), parts_.machine().shared.control, parts_.ports()); }
  std::string describe_stuck() const {
    return fmt::format("no progress for {} ms with {} rays outstanding; who waits for whom:",
                       options_.stuck_after.count(), parts_.count().outstanding.load()) +
           parts_.describe();
  }

  RunResult result(bool complete, double wall_seconds) {
    RunResult out;
    out.complete = complete;
    out.wall_seconds = wall_seconds;
    out.threads = threads_.count();
    out.start = start_;
    parts_.add_to(out);
    out.nearest = parts_.machine().shared.nearest();
    before_restart_.add_to(out);
    if (parts_.gate() != nullptr) add_rank(out);
    if (series_.on()) out.series = series_.finish();
    if (parts_.recorder() != nullptr) out.facts = parts_.recorder()->facts();
    return out;
  }

  /// Adds what this rank has counted of itself.
  void add_rank(RunResult& out) const {
    const RankShare& share = parts_.machine().shared.share;
    out.ranks.resize(share.ranks());
    RankResult& own = out.ranks[share.rank()];
    own.to = parts_.gate()->counts();
    own.waiting = std::min(1.0, threads_.waited().count() / (out.wall_seconds * static_cast<double>(threads_.count())));
    const ShapeTravel* const shapes = parts_.gate()->shapes();
    own.memory = {options_.scene_bytes, accel_.size_bytes(), shapes != nullptr ? shapes->guest_bytes() : 0,
                  peak_memory_bytes()};
  }

  const RunOptions& options_;
  const Config& config_;
  const accel::Accel& accel_;
  WorkerThreads threads_;
  NativeParts parts_;
  NativeSeries series_;
  HeartbeatMonitor heartbeat_;          // where a resource may stop
  std::optional<ResourceId> excluded_;  // it has stopped
  bool given_up_ = false;               // and the others go on without it
  CountsBeforeRestart before_restart_;
  bool stuck_ = false;
  Clock::time_point start_{};
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
