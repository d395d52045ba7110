#pragma once

#include <cstddef>
#include <span>

#include <boost/lockfree/spsc_queue.hpp>

#include "ringbus/queues/link_queue.h"

namespace carousel::ringbus {

/// Boost.Lockfree's spsc_queue.
template <class T>
class BoostSpscQueue {
 public:
  static constexpr Parties kProducers = Parties::kOne;
  static constexpr Parties kConsumers = Parties::kOne;

  explicit BoostSpscQueue(std::size_t capacity) : capacity_(capacity), queue_(capacity) {}

  bool try_push(const T& value) { return queue_.push(value); }
  bool try_pop(T& value) { return queue_.pop(value); }
  std::size_t try_push_n(std::span<const T> values) { return queue_.push(values.data(), values.size()); }
  std::size_t try_pop_n(std::span<T> values) { return queue_.pop(values.data(), values.size()); }
  std::size_t free_places() { return queue_.write_available(); }
  std::size_t capacity() const { return capacity_; }

 private:
  std::size_t capacity_;
  boost::lockfree::spsc_queue<T> queue_;
};

}  // namespace carousel::ringbus
