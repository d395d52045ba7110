#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <memory>
#include <span>

#include "ringbus/queues/link_queue.h"

namespace carousel::ringbus {

/// Lamport's single-producer single-consumer ring (Lamport, "Proving the correctness of multiprocess programs", 1977)
/// with each side caching the other's index (Lee, Bu, Chandranmenon, "A lock-free, cache-efficient multi-core
/// synchronization mechanism", MCRingBuffer, 2010) and one index update a batch: publishing 32 values at once costs
/// the cache line of the index one trip instead of 32. Indices count on and never wrap in practice (2^64).
template <class T>
class SpscRing {
 public:
  static constexpr Parties kProducers = Parties::kOne;
  static constexpr Parties kConsumers = Parties::kOne;

  /// `capacity` >= 1; storage is rounded up to a power of two, the capacity is not.
  explicit SpscRing(std::size_t capacity)
      : capacity_(capacity), mask_(std::bit_ceil(capacity) - 1), cells_(std::make_unique<T[]>(mask_ + 1)) {}

  /// Producer only.
  bool try_push(const T& value) {
    const std::size_t tail = producer_.index.load(std::memory_order_relaxed);   // own index
    if (tail - producer_.other == capacity_) {
      // Acquire: pairs with the release in try_pop and try_pop_n; cells seen as free have been read.
      producer_.other = consumer_.index.load(std::memory_order_acquire);
      if (tail - producer_.other == capacity_) return false;
    }
    cells_[tail & mask_] = value;
    // Release: pairs with the acquire in try_pop and try_pop_n; whoever sees the index sees the cell.
    producer_.index.store(tail + 1, std::memory_order_release);
    return true;
  }

  /// Consumer only.
  bool try_pop(T& value) {
    const std::size_t head = consumer_.index.load(std::memory_order_relaxed);   // own index
    if (head == consumer_.other) {
      // Acquire: pairs with the release in try_push and try_push_n.
      consumer_.other = producer_.index.load(std::memory_order_acquire);
      if (head == consumer_.other) return false;
    }
    value = cells_[head & mask_];
    // Release: pairs with the acquire in try_push and try_push_n; the cell may be overwritten now.
    consumer_.index.store(head + 1, std::memory_order_release);
    return true;
  }

  /// Producer only.
  std::size_t try_push_n(std::span<const T> values) {
    const std::size_t tail = producer_.index.load(std::memory_order_relaxed);   // own index
    if (capacity_ - (tail - producer_.other) < values.size())
      // Acquire: pairs with the release in try_pop_n; cells seen as free have been read.
      producer_.other = consumer_.index.load(std::memory_order_acquire);
    const std::size_t count = std::min(values.size(), capacity_ - (tail - producer_.other));
    for (std::size_t i = 0; i < count; ++i) cells_[(tail + i) & mask_] = values[i];
    // Release: pairs with the acquire in try_pop_n; whoever sees the index sees the cells.
    if (count > 0) producer_.index.store(tail + count, std::memory_order_release);
    return count;
  }

  /// Consumer only.
  std::size_t try_pop_n(std::span<T> values) {
    const std::size_t head = consumer_.index.load(std::memory_order_relaxed);   // own index
    if (consumer_.other - head < values.size())
      // Acquire: pairs with the release in try_push_n.
      consumer_.other = producer_.index.load(std::memory_order_acquire);
    const std::size_t count = std::min(values.size(), consumer_.other - head);
    for (std::size_t i = 0; i < count; ++i) values[i] = cells_[(head + i) & mask_];
    // Release: pairs with the acquire in try_push_n; the cells may be overwritten now.
    if (count > 0) consumer_.index.store(head + count, std::memory_order_release);
    return count;
  }

  /// Producer only.
  std::size_t free_places() {
    // Acquire: as in try_push_n, since a push may rely on the answer.
    producer_.other = consumer_.index.load(std::memory_order_acquire);
    return capacity_ - (producer_.index.load(std::memory_order_relaxed) - producer_.other);
  }
  std::size_t capacity() const { return capacity_; }

 private:
  // A line pair each: the two sides write at the same time, and the prefetcher fetches lines in pairs.
  struct alignas(128) Side {
    std::atomic<std::size_t> index{0};   // written by this side
    std::size_t other = 0;               // the other side's index as last seen
  };
  Side producer_, consumer_;
  alignas(128) std::size_t capacity_;   // read by both, written by none
  std::size_t mask_;
  std::unique_ptr<T[]> cells_;
};

}  // namespace carousel::ringbus
