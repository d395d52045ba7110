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

/// Pauses the calling thread and leaves the core to others.
void pause_for(std::chrono::nanoseconds time);

/// The state that the threads of a trial share with the thread that watches them. Trials derive from it. The threads
/// own it together, so that it outlives even threads that never return.
class WorkerGroup {
 public:
  explicit WorkerGroup(std::size_t threads) : progress_(threads) {}
  virtual ~WorkerGroup() = default;

  /// True when time is up: nothing new is to be sent.
  // Relaxed: a request only; no other data depends on it.
  bool stop_sending() const { return stop_sending_.load(std::memory_order_relaxed); }
  /// True when nothing moves any more: threads return.
  bool end() const { return end_.load(std::memory_order_relaxed); }
  /// Reports progress of thread `t`.
  void moved(std::size_t t) {
    // Relaxed: the watcher only looks for a change. No read-modify-write: each thread has its own counter.
    progress_[t].steps.store(progress_[t].steps.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }

  enum class Ending { kDone, kStuck, kNeverReturned };
  struct Limits {
    std::chrono::nanoseconds time;
    std::chrono::milliseconds stuck_after;
    std::stop_token stop;
  };
  /// Runs each body on a thread of its own, on different cores as far as there are any, starts them together and
  /// watches them. After kNeverReturned the group's members must not be read.
  static Ending run(const std::shared_ptr<WorkerGroup>& group, const std::vector<std::function<void()>>& bodies,
                    const Limits& limits);

 private:
  struct alignas(128) Progress {
    std::atomic<std::uint64_t> steps{0};
  };
  std::uint64_t steps() const;

  std::vector<Progress> progress_;
  std::atomic<bool> stop_sending_{false}, end_{false};
  std::mutex mutex_;  // guards the members below
  std::condition_variable changed_;
  std::size_t ready_ = 0, ended_ = 0;
};

}  // namespace carousel::ringbus::stress
