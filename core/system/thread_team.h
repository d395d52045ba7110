#pragma once

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace carousel {

/// Runs work(t) for `count` numbers t from `first` on, each on a thread of its own, and here() on the caller's; returns
/// when all are done. None begins before all threads are there: if one cannot be started, none works, and the
/// std::system_error is thrown. `work` must not throw.
template <class Work, class Here>
void run_team(std::size_t first, std::size_t count, const Work& work, const Here& here) {
  enum Gate { kClosed, kOpen, kGivenUp };
  std::atomic<Gate> gate{kClosed};
  // Release pairs with the acquire of the threads: what the caller wrote is there for them.
  const auto open = [&](Gate how) {
    gate.store(how, std::memory_order_release);
    gate.notify_all();
  };
  std::vector<std::jthread> threads;
  try {
    for (std::size_t t = first; t < first + count; ++t)
      threads.emplace_back([&, t] {
        gate.wait(kClosed, std::memory_order_acquire);
        if (gate.load(std::memory_order_acquire) == kOpen) work(t);
      });
  } catch (...) {
    open(kGivenUp);
    throw;
  }
  open(kOpen);
  here();
}

}  // namespace carousel
