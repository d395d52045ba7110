#include "app/host/interrupt.h"

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <mutex>

namespace carousel::app {

namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};

std::atomic<int> g_signal{0};  // the first that came
static_assert(std::atomic<int>::is_always_lock_free, "written by a signal handler");

// Relaxed here and below: the number guards no data.
void on_signal(int number) {
  int none = 0;
  if (g_signal.compare_exchange_strong(none, number, std::memory_order_relaxed)) return;
  std::signal(number, SIG_DFL);
  std::raise(number);  // is blocked until this handler has returned
}

}  // namespace

InterruptScope::InterruptScope() {
  g_signal.store(0, std::memory_order_relaxed);
  for (const int number : kSignals) {
    struct sigaction action {
    }, before{};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    sigaction(number, &action, &before);
    if (before.sa_handler == SIG_IGN) sigaction(number, &before, nullptr);
  }
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

bool InterruptScope::interrupted() const {
  return g_signal.load(std::memory_order_relaxed) != 0;
}

int interrupting_signal() {
  return g_signal.load(std::memory_order_relaxed);
}

void adopt_signal(int number) {
  int none = 0;
  g_signal.compare_exchange_strong(none, number, std::memory_order_relaxed);
}

ExitStatus interrupted_status() {
  const int number = interrupting_signal();
  return number == 0 ? kInterrupted : static_cast<ExitStatus>(128 + number);
}

}  // namespace carousel::app
