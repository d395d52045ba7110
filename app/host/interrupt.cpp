#include "app/host/interrupt.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <mutex>

namespace carousel::app {

namespace {

std::atomic<bool> g_interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "written by a signal handler");

// Relaxed here and below: the flag guards no data.
void on_interrupt(int) {
  g_interrupted.store(true, std::memory_order_relaxed);
}

}  // namespace

InterruptScope::InterruptScope() {
  g_interrupted.store(false, std::memory_order_relaxed);
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);  // the second signal ends the program
  sigaction(SIGINT, &action, nullptr);
  watcher_ = std::jthread([this](std::stop_token ended) {
    std::mutex mutex;
    std::condition_variable_any wake;
    std::unique_lock lock(mutex);
    while (!ended.stop_requested()) {
      if (interrupted()) {
        source_.request_stop();
        return;
      }
      wake.wait_for(lock, ended, std::chrono::milliseconds(20), [] { return false; });
    }
  });
}

InterruptScope::~InterruptScope() {
  struct sigaction action {};
  action.sa_handler = SIG_DFL;
  sigaction(SIGINT, &action, nullptr);
}

bool InterruptScope::interrupted() const {
  return g_interrupted.load(std::memory_order_relaxed);
}

}  // namespace carousel::app
