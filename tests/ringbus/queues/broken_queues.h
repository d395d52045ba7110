#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "ringbus/queues/link_queue.h"

namespace carousel::ringbus {

// Queues with errors that a stress run must find. Everything is done under a mutex, so that the error is the one that
// the comment names and no data race.

template <class T>
class BrokenBase {
 public:
  static constexpr Parties kProducers = Parties::kMany;
  static constexpr Parties kConsumers = Parties::kMany;
  explicit BrokenBase(std::size_t capacity) : capacity_(capacity) {}
  std::size_t capacity() const { return capacity_; }
  std::size_t free_places() {
    const std::lock_guard lock(mutex_);
    return capacity_ - std::min(capacity_, values_.size());
  }

 protected:
  std::size_t capacity_;
  std::mutex mutex_;
  std::deque<T> values_;
};

/// When its index has gone round a few times, the newest value overwrites the oldest.
template <class T>
class LosesAtWrap : public BrokenBase<T> {
 public:
  using BrokenBase<T>::BrokenBase;
  bool try_push(const T& value) {
    const std::lock_guard lock(this->mutex_);
    if (this->values_.size() == this->capacity_) return false;
    if (pushed_ % (4 * this->capacity_) == this->capacity_ && !this->values_.empty()) this->values_.pop_front();
    this->values_.push_back(value);
    ++pushed_;
    return true;
  }
  bool try_pop(T& value) {
    const std::lock_guard lock(this->mutex_);
    if (this->values_.empty()) return false;
    value = this->values_.front();
    this->values_.pop_front();
    return true;
  }
  std::size_t try_push_n(std::span<const T> values) { return push_one_by_one(*this, values); }
  std::size_t try_pop_n(std::span<T> values) { return pop_one_by_one(*this, values); }

 private:
  std::size_t pushed_ = 0;
};

/// Now and then the second value is popped before the first.
template <class T>
class Reorders : public BrokenBase<T> {
 public:
  using BrokenBase<T>::BrokenBase;
  bool try_push(const T& value) {
    const std::lock_guard lock(this->mutex_);
    if (this->values_.size() == this->capacity_) return false;
    this->values_.push_back(value);
    return true;
  }
  bool try_pop(T& value) {
    const std::lock_guard lock(this->mutex_);
    if (this->values_.empty()) return false;
    if (++pops_ % 100 == 0 && this->values_.size() > 1) std::swap(this->values_[0], this->values_[1]);
    value = this->values_.front();
    this->values_.pop_front();
    return true;
  }
  std::size_t try_push_n(std::span<const T> values) { return push_one_by_one(*this, values); }
  std::size_t try_pop_n(std::span<T> values) { return pop_one_by_one(*this, values); }

 private:
  std::size_t pops_ = 0;
};

/// Publishes a value before all of it is written: now and then the last word comes later. One thread never notices.
template <class T>
class Tears : public BrokenBase<T> {
 public:
  using BrokenBase<T>::BrokenBase;
  bool try_push(const T& value) {
    std::unique_lock lock(this->mutex_);
    if (this->values_.size() == this->capacity_) return false;
    this->values_.push_back(value);
    if (++pushes_ % 50 == 0) {
      std::swap(this->values_.back().words.back(), late_);
      const std::size_t popped = popped_, place = this->values_.size() - 1;
      lock.unlock();
      std::this_thread::sleep_for(std::chrono::microseconds(300));  // so that a consumer pops meanwhile
      lock.lock();
      if (popped_ - popped <= place) this->values_[place - (popped_ - popped)].words.back() = value.words.back();
    }
    return true;
  }
  bool try_pop(T& value) {
    const std::lock_guard lock(this->mutex_);
    if (this->values_.empty()) return false;
    value = this->values_.front();
    this->values_.pop_front();
    ++popped_;
    return true;
  }
  std::size_t try_push_n(std::span<const T> values) { return push_one_by_one(*this, values); }
  std::size_t try_pop_n(std::span<T> values) { return pop_one_by_one(*this, values); }

 private:
  std::size_t pushes_ = 0, popped_ = 0;
  std::uint64_t late_ = 0;
};

/// Takes messages, and after a while gives none back.
template <class T>
class Sticks : public Reorders<T> {
 public:
  using Reorders<T>::Reorders;
  bool try_pop(T& value) {
    const std::lock_guard lock(this->mutex_);
    if (this->values_.empty() || pops_ > 2000) return false;
    ++pops_;
    value = this->values_.front();
    this->values_.pop_front();
    return true;
  }
  std::size_t try_pop_n(std::span<T> values) { return pop_one_by_one(*this, values); }

 private:
  std::size_t pops_ = 0;
};

/// Has a call that never returns once it has been called often enough.
template <class T>
class NeverReturns : public Sticks<T> {
 public:
  using Sticks<T>::Sticks;
  bool try_push(const T& value) {
    if (++calls_ > 3000) std::this_thread::sleep_for(std::chrono::hours(1));
    return Sticks<T>::try_push(value);
  }
  std::size_t try_push_n(std::span<const T> values) { return push_one_by_one(*this, values); }

 private:
  std::size_t calls_ = 0;
};

}  // namespace carousel::ringbus
