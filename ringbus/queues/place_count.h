#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>

namespace carousel::ringbus {

/// Bounds a queue that has no bound of its own, or a coarser one: a push first takes a place, a pop gives it back.
class PlaceCount {
 public:
  explicit PlaceCount(std::size_t capacity) : capacity_(capacity) {}

  /// Takes up to `want` places; returns how many.
  std::size_t take(std::size_t want) {
    // Relaxed: only a guess; the compare-and-swap decides.
    std::size_t taken = taken_.load(std::memory_order_relaxed);
    for (;;) {
      const std::size_t count = std::min(want, capacity_ - taken);
      if (count == 0) return 0;
      // Acquire: pairs with the release in give(); the pop that gave the place is over.
      if (taken_.compare_exchange_weak(taken, taken + count, std::memory_order_acquire, std::memory_order_relaxed))
        return count;
    }
  }
  void give(std::size_t count) {
    // Release: pairs with the acquire in take() and free().
    if (count > 0) taken_.fetch_sub(count, std::memory_order_release);
  }
  std::size_t free() const { return capacity_ - taken_.load(std::memory_order_acquire); }
  std::size_t capacity() const { return capacity_; }

 private:
  alignas(128) std::atomic<std::size_t> taken_{0};  // a line pair of its own: all threads write it
  alignas(128) std::size_t capacity_;
};

}  // namespace carousel::ringbus
