#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

namespace carousel::ringbus {

/// Ends a run that takes far too long, so that it is reported as incomplete; if that is in vain, aborts the program.
/// `patience` is CPU time of the process, so that other work on the host ends no run; a run that sleeps for ever is
/// ended after ten times as much on the wall.
class Watchdog {
 public:
  Watchdog(std::chrono::seconds patience, std::string run)
      : thread_([this, patience, run = std::move(run)](const std::stop_token& over) {
          std::unique_lock lock(mutex_);
          wait(lock, over, patience);
          if (!over.stop_requested()) run_.request_stop();
          wait(lock, over, patience / 3);
          if (over.stop_requested()) return;
          std::cerr << "does not end: " << run << std::endl;
          std::abort();
        }) {}
  std::stop_token token() const { return run_.get_token(); }

 private:
  static double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }
  void wait(std::unique_lock<std::mutex>& lock, const std::stop_token& over, std::chrono::seconds patience) {
    const auto end = std::chrono::steady_clock::now() + 10 * patience;
    const double cpu_end = cpu_seconds() + static_cast<double>(patience.count());
    while (!over.stop_requested() && cpu_seconds() < cpu_end && std::chrono::steady_clock::now() < end)
      over_.wait_for(lock, over, std::chrono::milliseconds(100), [] { return false; });
  }

  std::stop_source run_;
  std::mutex mutex_;
  std::condition_variable_any over_;
  std::jthread thread_;
};

}  // namespace carousel::ringbus
