#include "ringbus/native_engine.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>

#include <fmt/format.h>

#include "core/error.h"
#include "ringbus/machine.h"
#include "ringbus/native_port.h"
#include "ringbus/shader_worker.h"

namespace carousel::ringbus {

namespace {

/// One engine run: who steps what, and how it ends.
class NativeRun {
 public:
  NativeRun(const Config& config, const accel::Accel& accel, float scene_size, Workload& workload,
            const RunOptions& options)
      : options_(options), machine_(config, accel, scene_size) {
    const std::uint32_t resources = static_cast<std::uint32_t>(config.topology.resources);
    for (std::uint32_t r = 0; r < resources; ++r) {
      sinks_.push_back(options.statistics ? std::make_unique<StatisticsSink>() : nullptr);
      ports_.push_back(std::make_unique<NativePort>(ResourceId(r), machine_, scene_size, sinks_.back().get()));
    }
    for (const auto& link : machine_.links) link->count(options.statistics);
    for (std::uint32_t w = 0; w < static_cast<std::uint32_t>(config.shading.workers); ++w)
      workers_.push_back(std::make_unique<ShaderWorker>(WorkerId(w), machine_, workload, count_));
    threads_ = std::clamp<std::size_t>(options.threads, 1, std::max(ports_.size(), workers_.size()));
    progress_ = std::make_unique<Progress[]>(threads_);
  }

  RunResult run() {
    const auto start = start_ = std::chrono::steady_clock::now();
    {
      std::vector<std::jthread> threads;
      for (std::size_t t = 0; t < threads_; ++t) threads.emplace_back([this, t] { work(t); });
      watch();
    }
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    if (error_) std::rethrow_exception(error_);
    if (stuck_) throw SimulationError(describe_stuck());
    const bool complete = count_.done();
    if (complete) check_drained();
    return result(complete, wall.count());
  }

 private:
  struct alignas(128) Progress {
    std::atomic<std::uint64_t> steps{0};   // that moved something
  };

  void work(std::size_t thread) {
    try {
      int idle = 0;
      // Acquire: pairs with the release that asks everyone to end.
      while (!end_.load(std::memory_order_acquire)) {
        bool moved = false;
        for (std::size_t r = thread; r < ports_.size(); r += threads_) moved |= ports_[r]->step();
        for (std::size_t w = thread; w < workers_.size(); w += threads_) moved |= workers_[w]->step();
        if (moved) {
          idle = 0;
          // Relaxed: the watcher only wants to see it change.
          progress_[thread].steps.fetch_add(1, std::memory_order_relaxed);
        } else if (count_.done() && packets_out() == 0) {
          break;
        } else if (++idle < 256) {
          // Two threads on one core must not wait out each other's time slices.
          std::this_thread::yield();
        } else {
          std::this_thread::sleep_for(std::chrono::microseconds(50));
        }
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      end_.store(true, std::memory_order_release);
    }
    const std::lock_guard lock(mutex_);
    ++ended_;
    ended_changed_.notify_all();
  }

  // When the last ray has been shaded, packets may still be on their way home, through resources of any thread.
  // From then on none is sent out any more, so a sum of zero stays zero.
  std::uint64_t packets_out() const {
    std::uint64_t out = 0;
    for (const auto& port : ports_) out += port->packets_out();
    return out;
  }

  /// On the calling thread: progress reports, the request to stop, and the run that no longer moves.
  void watch() {
    using Clock = std::chrono::steady_clock;
    std::uint64_t last = 0;
    Clock::time_point last_change = Clock::now();
    std::unique_lock lock(mutex_);
    while (!ended_changed_.wait_for(lock, std::chrono::milliseconds(100), [this] { return ended_ == threads_; })) {
      if (options_.progress) options_.progress(count_.completed.load(std::memory_order_relaxed));
      std::uint64_t steps = 0;
      for (std::size_t t = 0; t < threads_; ++t) steps += progress_[t].steps.load(std::memory_order_relaxed);
      if (steps != last) {
        last = steps;
        last_change = Clock::now();
      } else if (Clock::now() - last_change > options_.stuck_after) {
        stuck_ = true;
      }
      // Release: pairs with the acquire in work().
      if (stuck_ || options_.stop.stop_requested()) end_.store(true, std::memory_order_release);
    }
  }

  std::string describe_stuck() const {
    std::string text = fmt::format("no progress for {} ms with {} rays outstanding; who waits for whom:",
                                   options_.stuck_after.count(), count_.outstanding.load());
    for (const auto& port : ports_) text += "\n  " + port->describe();
    return text;
  }

  void check_drained() const {
    if (count_.emitted != count_.completed)
      throw SimulationError(fmt::format("{} rays emitted, {} completed", count_.emitted.load(), count_.completed.load()));
    for (const auto& port : ports_)
      if (!port->drained()) throw SimulationError("not everything came home: " + port->describe());
  }

  RunResult result(bool complete, double wall_seconds) const {
    RunResult out;
    out.complete = complete;
    out.rays_emitted = count_.emitted;
    out.rays_completed = count_.completed;
    out.wall_seconds = wall_seconds;
    out.threads = threads_;
    out.slots_used = machine_.control.slots_used();
    out.slot_waits = machine_.control.slot_waits();
    for (std::size_t r = 0; r < ports_.size(); ++r) {
      if (sinks_[r]) out.resources.push_back(sinks_[r]->statistics());
      out.collections.push_back(ports_[r]->resource().collections().statistics());
    }
    for (const auto& link : machine_.links)
      out.links.push_back({link->from(), link->to(), link->capacity(), link->statistics(), link->series(), link->faults()});
    out.start = start_;
    return out;
  }

  const RunOptions& options_;
  Machine machine_;
  RayCount count_;
  std::vector<std::unique_ptr<StatisticsSink>> sinks_;
  std::vector<std::unique_ptr<NativePort>> ports_;
  std::vector<std::unique_ptr<ShaderWorker>> workers_;
  std::size_t threads_;
  std::chrono::steady_clock::time_point start_{};
  std::unique_ptr<Progress[]> progress_;
  std::atomic<bool> end_{false};
  bool stuck_ = false;
  std::mutex mutex_;                         // guards ended_ and error_
  std::condition_variable ended_changed_;
  std::size_t ended_ = 0;
  std::exception_ptr error_;
};

}  // namespace

RunResult run_native(const Config& config, const accel::Accel& accel, float scene_size, Workload& workload,
                     const RunOptions& options) {
  return NativeRun(config, accel, scene_size, workload, options).run();
}

}  // namespace carousel::ringbus
