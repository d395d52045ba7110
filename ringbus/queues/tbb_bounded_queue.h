#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include <tbb/concurrent_queue.h>

#include "ringbus/queues/link_queue.h"

namespace carousel::ringbus {

/// oneTBB's concurrent_bounded_queue, through its non-blocking calls.
template <class T>
class TbbBoundedQueue {
 public:
  static constexpr Parties kProducers = Parties::kMany;
  static constexpr Parties kConsumers = Parties::kMany;

  explicit TbbBoundedQueue(std::size_t capacity) : capacity_(capacity) {
    queue_.set_capacity(static_cast<std::ptrdiff_t>(capacity));
  }

  bool try_push(const T& value) { return queue_.try_push(value); }
  bool try_pop(T& value) { return queue_.try_pop(value); }
  std::size_t try_push_n(std::span<const T> values) { return push_one_by_one(*this, values); }
  std::size_t try_pop_n(std::span<T> values) { return pop_one_by_one(*this, values); }
  std::size_t free_places() {
    const std::ptrdiff_t size = queue_.size();  // below zero while pops wait
    return size <= 0 ? capacity_ : capacity_ - std::min(capacity_, static_cast<std::size_t>(size));
  }
  std::size_t capacity() const { return capacity_; }

 private:
  std::size_t capacity_;
  tbb::concurrent_bounded_queue<T> queue_;
};

}  // namespace carousel::ringbus
