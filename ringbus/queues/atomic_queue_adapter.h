#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include <atomic_queue/atomic_queue.h>

#include "ringbus/queues/link_queue.h"
#include "ringbus/queues/place_count.h"

namespace carousel::ringbus {

/// Maxim Egorushkin's AtomicQueueB2. Its own capacity is a power of two of at least 4,096; less is bounded by a count
/// of places. A call that has its ticket spins until the cell's last user is done, so where several threads push (pop)
/// and one of them is preempted, others may burn their time slices waiting for it.
template <class T>
class AtomicQueue {
 public:
  static constexpr Parties kProducers = Parties::kMany;
  static constexpr Parties kConsumers = Parties::kMany;

  explicit AtomicQueue(std::size_t capacity)
      : queue_(static_cast<unsigned>(capacity)), places_(capacity), counted_(queue_.capacity() != capacity) {}

  bool try_push(const T& value) {
    if (!counted_) return queue_.try_push(value);
    // The queue itself has room for more than there are places.
    return places_.take(1) == 1 && queue_.try_push(value);
  }
  bool try_pop(T& value) {
    if (!queue_.try_pop(value)) return false;
    if (counted_) places_.give(1);
    return true;
  }
  std::size_t try_push_n(std::span<const T> values) { return push_one_by_one(*this, values); }
  std::size_t try_pop_n(std::span<T> values) { return pop_one_by_one(*this, values); }
  std::size_t free_places() {
    return counted_ ? places_.free() : capacity() - std::min<std::size_t>(capacity(), queue_.was_size());
  }
  std::size_t capacity() const { return places_.capacity(); }

 private:
  atomic_queue::AtomicQueueB2<T> queue_;
  PlaceCount places_;
  bool counted_;
};

}  // namespace carousel::ringbus
