#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "ringbus/schedule/schedule.h"

namespace carousel::ringbus {

/// The threads of a native run, or under a Schedule the agents that stand in for them. They play until each finds that
/// the run is over, until end() is called, or until one of them throws.
class WorkerThreads {
 public:
  explicit WorkerThreads(std::size_t threads) : threads_(threads), progress_(std::make_unique<Progress[]>(threads)) {}

  std::size_t count() const { return threads_; }

  /// Calls `body(t)` on thread t, for each, and `watch()` on the calling thread, which has to call watch() below. The
  /// threads are joined when it returns. May be called again when all have ended.
  template <class Body, class Watch>
  void run(const Body& body, const Watch& watch) {
    ended_ = 0;
    end_ = false;
    if (Schedule* const schedule = Schedule::current(); schedule != nullptr) {
      for (std::size_t t = 0; t < threads_; ++t) schedule->start([this, body, t] { play(body, t); });
      return watch();
    }
    std::vector<std::jthread> threads;
    try {
      for (std::size_t t = 0; t < threads_; ++t) threads.emplace_back([this, &body, t] { play(body, t); });
    } catch (...) {  // no further thread can be started: those that run have to end
      end();
      throw;
    }
    watch();
  }
  /// Calls `look()` whenever `pause` is over, until all threads have ended. No thread ends while it looks.
  template <class Look>
  void watch(ScheduleClock::duration pause, const Look& look) {
    std::unique_lock lock(mutex_);
    while (!schedule_wait(ended_changed_, lock, pause, [this] { return ended_ == threads_; })) look();
  }

  /// Asks all threads to end. Any thread may call.
  // Release: pairs with the acquire in ending().
  void end() { end_.store(true, std::memory_order_release); }
  /// Every body returns soon after it finds this true.
  bool ending() const { return end_.load(std::memory_order_acquire); }
  /// The first exception that a thread has thrown; once all have ended.
  const std::exception_ptr& error() const { return error_; }

  /// A thread has moved something. It alone may call.
  // Relaxed: the watcher only wants to see it change.
  void note_step(std::size_t thread) { progress_[thread].steps.fetch_add(1, std::memory_order_relaxed); }
  /// A thread has looked for something to move, and found nothing. It alone may call.
  void note_look(std::size_t thread) { progress_[thread].looks.fetch_add(1, std::memory_order_relaxed); }
  /// Whether each has looked since the last call. Only who watches may call.
  bool all_have_looked() {
    bool all = true;
    for (std::size_t t = 0; t < threads_; ++t) {
      const std::uint64_t looks = progress_[t].looks.load(std::memory_order_relaxed);
      all = all && looks != std::exchange(progress_[t].looks_seen, looks);
    }
    return all;
  }
  /// A thread has had nothing to do for so long. It alone may call.
  void note_waited(std::size_t thread, std::chrono::nanoseconds time) { progress_[thread].waited += time; }
  /// Steps noted so far by all.
  std::uint64_t steps() const {
    std::uint64_t steps = 0;
    for (std::size_t t = 0; t < threads_; ++t) steps += progress_[t].steps.load(std::memory_order_relaxed);
    return steps;
  }
  /// Seconds that they waited, summed, once all have ended.
  std::chrono::duration<double> waited() const {
    std::chrono::duration<double> waited{0};
    for (std::size_t t = 0; t < threads_; ++t) waited += progress_[t].waited;
    return waited;
  }

 private:
  struct alignas(128) Progress {
    std::atomic<std::uint64_t> steps{0};
    std::atomic<std::uint64_t> looks{0};
    std::uint64_t looks_seen = 0;  // of who watches
    std::chrono::nanoseconds waited{0};
  };

  template <class Body>
  void play(const Body& body, std::size_t thread) {
    try {
      body(thread);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      end();
    }
    const std::lock_guard lock(mutex_);
    ++ended_;
    ended_changed_.notify_all();
  }

  std::size_t threads_;
  std::unique_ptr<Progress[]> progress_;
  std::atomic<bool> end_{false};
  std::mutex mutex_;  // guards ended_ and error_
  std::condition_variable ended_changed_;
  std::size_t ended_ = 0;
  std::exception_ptr error_;
};

}  // namespace carousel::ringbus
