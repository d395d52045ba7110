#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <vector>

namespace carousel::ringbus::stress {

using Clock = std::chrono::steady_clock;
inline std::int64_t now_ns() {
  return std::chrono::nanoseconds(Clock::now().time_since_epoch()).count();
}

/// Pauses a thread without keeping the core from others.
void pause_for(std::chrono::nanoseconds time);

/// What the threads of a trial and the thread that watches them share. Trials derive from it; the threads hold it, so
/// that it outlives even those that never return.
class WorkerGroup {
 public:
  explicit WorkerGroup(std::size_t threads) : progress_(threads) {}
  virtual ~WorkerGroup() = default;

  /// Time is up: nothing new is to be sent.
  // Relaxed: only asks; nothing is read by its leave.
  bool stop_sending() const { return stop_sending_.load(std::memory_order_relaxed); }
  /// Nothing moves any more: leave.
  bool end() const { return end_.load(std::memory_order_relaxed); }
  /// Thread `t` has got something done.
  void moved(std::size_t t) {
    // Relaxed: the watcher only wants to see it change. No read-modify-write: each has its own.
    progress_[t].steps.store(progress_[t].steps.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }

  enum class Ending { kDone, kStuck, kNeverReturned };
  struct Limits {
    std::chrono::nanoseconds time;
    std::chrono::milliseconds stuck_after;
    std::stop_token stop;
  };
  /// Runs one body a thread, on a core each as far as they go, started together, and watches them. After kNeverReturned
  /// the crew must not be read.
  static Ending run(const std::shared_ptr<WorkerGroup>& crew, const std::vector<std::function<void()>>& bodies,
                    const Limits& limits);

 private:
  struct alignas(128) Progress {
    std::atomic<std::uint64_t> steps{0};
  };
  std::uint64_t steps() const;

  std::vector<Progress> progress_;
  std::atomic<bool> stop_sending_{false}, end_{false};
  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::size_t ready_ = 0, ended_ = 0;
};

}  // namespace carousel::ringbus::stress
