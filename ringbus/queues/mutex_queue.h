#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <mutex>
#include <span>

#include "ringbus/queues/link_queue.h"

namespace carousel::ringbus {

/// The baseline: a deque behind a mutex.
template <class T>
class MutexQueue {
 public:
  static constexpr Parties kProducers = Parties::kMany;
  static constexpr Parties kConsumers = Parties::kMany;

  explicit MutexQueue(std::size_t capacity) : capacity_(capacity) {}

  bool try_push(const T& value) { return try_push_n({&value, 1}) == 1; }
  bool try_pop(T& value) { return try_pop_n({&value, 1}) == 1; }
  std::size_t try_push_n(std::span<const T> values) {
    const std::lock_guard lock(mutex_);
    const std::size_t count = std::min(values.size(), capacity_ - values_.size());
    values_.insert(values_.end(), values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
  }
  std::size_t try_pop_n(std::span<T> values) {
    const std::lock_guard lock(mutex_);
    const std::size_t count = std::min(values.size(), values_.size());
    for (std::size_t i = 0; i < count; ++i) {
      values[i] = values_.front();
      values_.pop_front();
    }
    return count;
  }
  std::size_t free_places() {
    const std::lock_guard lock(mutex_);
    return capacity_ - values_.size();
  }
  std::size_t capacity() const { return capacity_; }

 private:
  std::size_t capacity_;
  std::mutex mutex_;
  std::deque<T> values_;
};

}  // namespace carousel::ringbus
