#pragma once

#include <cstddef>
#include <span>

#include <atomic_queue/atomic_queue.h>
#include <readerwriterqueue/readerwritercircularbuffer.h>
#include <readerwriterqueue/readerwriterqueue.h>

#include "ringbus/queues/link_queue.h"

namespace carousel::bench {

using ringbus::Parties;

// Other queues as their authors intend them: without the exact capacity that a link needs, and without a wrapper.

/// AtomicQueueB2, for many producers and consumers or in its mode for one of each.
template <class T, bool kSpsc>
class RawAtomicQueue {
 public:
  static constexpr Parties kProducers = kSpsc ? Parties::kOne : Parties::kMany;
  static constexpr Parties kConsumers = kProducers;
  explicit RawAtomicQueue(std::size_t capacity) : queue_(static_cast<unsigned>(capacity)) {}
  bool try_push(const T& value) { return queue_.try_push(value); }
  bool try_pop(T& value) { return queue_.try_pop(value); }
  std::size_t try_push_n(std::span<const T> values) { return ringbus::push_one_by_one(*this, values); }
  std::size_t try_pop_n(std::span<T> values) { return ringbus::pop_one_by_one(*this, values); }
  std::size_t free_places() { return queue_.capacity() - queue_.was_size(); }
  std::size_t capacity() const { return queue_.capacity(); }

 private:
  atomic_queue::AtomicQueueB2<T, std::allocator<T>, true, false, kSpsc> queue_;
};
template <class T>
using AtomicQueueSpsc = RawAtomicQueue<T, true>;
template <class T>
using AtomicQueueMpmc = RawAtomicQueue<T, false>;

/// moodycamel::ReaderWriterQueue: blocks of a ring; try_enqueue never allocates.
template <class T>
class ReaderWriterQueue {
 public:
  static constexpr Parties kProducers = Parties::kOne, kConsumers = Parties::kOne;
  explicit ReaderWriterQueue(std::size_t capacity) : capacity_(capacity), queue_(capacity) {}
  bool try_push(const T& value) { return queue_.try_enqueue(value); }
  bool try_pop(T& value) { return queue_.try_dequeue(value); }
  std::size_t try_push_n(std::span<const T> values) { return ringbus::push_one_by_one(*this, values); }
  std::size_t try_pop_n(std::span<T> values) { return ringbus::pop_one_by_one(*this, values); }
  std::size_t free_places() { return 0; }
  std::size_t capacity() const { return capacity_; }

 private:
  std::size_t capacity_;
  moodycamel::ReaderWriterQueue<T> queue_;
};

/// moodycamel::BlockingReaderWriterCircularBuffer through its calls that do not block.
template <class T>
class CircularBuffer {
 public:
  static constexpr Parties kProducers = Parties::kOne, kConsumers = Parties::kOne;
  explicit CircularBuffer(std::size_t capacity) : queue_(capacity) {}
  bool try_push(const T& value) { return queue_.try_enqueue(value); }
  bool try_pop(T& value) { return queue_.try_dequeue(value); }
  std::size_t try_push_n(std::span<const T> values) { return ringbus::push_one_by_one(*this, values); }
  std::size_t try_pop_n(std::span<T> values) { return ringbus::pop_one_by_one(*this, values); }
  std::size_t free_places() { return queue_.max_capacity() - queue_.size_approx(); }
  std::size_t capacity() const { return queue_.max_capacity(); }

 private:
  moodycamel::BlockingReaderWriterCircularBuffer<T> queue_;
};

}  // namespace carousel::bench
