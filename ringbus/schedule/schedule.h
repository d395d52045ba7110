#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace carousel::ringbus {

/// Decides which agent of the native engine runs next, in place of the host's scheduler. All agents of a run then share
/// the thread that has called the engine: one of them runs until it comes to a schedule_point(), where the schedule may
/// let another one go on. A test draws such a schedule from a seed, so that it can repeat an order of steps that has
/// broken something. Nothing else is different: agents execute the code that threads do.
///
/// A run whose calling thread follows no schedule has threads of its own. It pays for this class with a load and a
/// branch at each point, and a point comes once a batch of packets or rays.
class Schedule {
 public:
  using Clock = std::chrono::steady_clock;
  virtual ~Schedule() = default;

  /// Adds an agent, which begins at some schedule_point() from now on. It must not let an exception out.
  virtual void start(std::function<void()> agent) = 0;
  /// Returns when it is the caller's turn again, which may be at once.
  virtual void yield() = 0;
  /// The time that the agents see. It never goes back.
  virtual Clock::time_point now() = 0;

  /// The schedule that runs on the calling thread follow; null: none.
  static Schedule* current() { return current_; }
  /// Makes the calling thread follow a schedule, or none.
  static void follow(Schedule* schedule) { current_ = schedule; }

 private:
  static inline constinit thread_local Schedule* current_ = nullptr;
};

/// A place at which another agent may go on. A caller may hold a ScheduleMutex, but no other one.
inline void schedule_point() {
  if (Schedule* const schedule = Schedule::current(); schedule != nullptr) [[unlikely]]
    schedule->yield();
}

/// As schedule_point(), for a caller that has nothing to do: without a schedule, other threads of the host go on.
inline void schedule_pause() {
  Schedule* const schedule = Schedule::current();
  schedule == nullptr ? std::this_thread::yield() : schedule->yield();
}

/// The clock of the native engine: the host's, or that of the schedule.
struct ScheduleClock {
  using duration = Schedule::Clock::duration;
  using time_point = Schedule::Clock::time_point;
  static time_point now() {
    Schedule* const schedule = Schedule::current();
    return schedule == nullptr ? Schedule::Clock::now() : schedule->now();
  }
};

/// A mutex that may be held at a schedule_point(). Under a schedule, an agent that waits for it lets others go on.
class ScheduleMutex {
 public:
  void lock() {
    Schedule* const schedule = Schedule::current();
    if (schedule == nullptr) return mutex_.lock();
    while (held_) schedule->yield();
    held_ = true;
  }
  void unlock() {
    if (Schedule::current() == nullptr) return mutex_.unlock();
    held_ = false;
  }

 private:
  std::mutex mutex_;
  bool held_ = false;  // only under a schedule, whose agents share a thread
};

/// As changed.wait_for(lock, span, over). Under a schedule the other agents go on until `over` or the end of the time.
template <class Over>
bool schedule_wait(std::condition_variable& changed, std::unique_lock<std::mutex>& lock, ScheduleClock::duration span,
                   const Over& over) {
  Schedule* const schedule = Schedule::current();
  if (schedule == nullptr) return changed.wait_for(lock, span, over);
  const ScheduleClock::time_point end = schedule->now() + span;
  lock.unlock();
  while (!over() && schedule->now() < end) schedule->yield();
  lock.lock();
  return over();
}

}  // namespace carousel::ringbus
