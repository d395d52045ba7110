#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <iostream>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

namespace carousel::ringbus {

/// Ends a run that takes far too long, so that it is reported as incomplete; if that is in vain, aborts the program.
class Watchdog {
 public:
  Watchdog(std::chrono::seconds patience, std::string run)
      : thread_([this, patience, run = std::move(run)](const std::stop_token& over) {
          std::unique_lock lock(mutex_);
          over_.wait_for(lock, over, patience, [] { return false; });
          if (!over.stop_requested()) run_.request_stop();
          over_.wait_for(lock, over, patience / 3, [] { return false; });
          if (over.stop_requested()) return;
          std::cerr << "does not end: " << run << std::endl;
          std::abort();
        }) {}
  std::stop_token token() const { return run_.get_token(); }

 private:
  std::stop_source run_;
  std::mutex mutex_;
  std::condition_variable_any over_;
  std::jthread thread_;
};

}  // namespace carousel::ringbus
