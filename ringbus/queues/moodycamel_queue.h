#pragma once

#include <cstddef>
#include <span>

#include <concurrentqueue/concurrentqueue.h>

#include "ringbus/queues/link_queue.h"
#include "ringbus/queues/place_count.h"

namespace carousel::ringbus {

/// Cameron Desrochers' moodycamel::ConcurrentQueue, bounded by a count of places. Keeps the order of each producer, not
/// one order of all.
template <class T>
class MoodycamelQueue {
 public:
  static constexpr Parties kProducers = Parties::kMany;
  static constexpr Parties kConsumers = Parties::kMany;

  explicit MoodycamelQueue(std::size_t capacity) : places_(capacity), queue_(capacity) {}

  bool try_push(const T& value) {
    if (places_.take(1) == 0) return false;
    queue_.enqueue(value);  // may allocate
    return true;
  }
  bool try_pop(T& value) {
    if (!queue_.try_dequeue(value)) return false;
    places_.give(1);
    return true;
  }
  std::size_t try_push_n(std::span<const T> values) {
    const std::size_t count = places_.take(values.size());
    if (count > 0) queue_.enqueue_bulk(values.data(), count);
    return count;
  }
  std::size_t try_pop_n(std::span<T> values) {
    const std::size_t count = queue_.try_dequeue_bulk(values.data(), values.size());
    places_.give(count);
    return count;
  }
  std::size_t free_places() { return places_.free(); }
  std::size_t capacity() const { return places_.capacity(); }

 private:
  PlaceCount places_;
  moodycamel::ConcurrentQueue<T> queue_;
};

}  // namespace carousel::ringbus
