#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace carousel::ringbus {

/// First in, first out, in one piece of memory that doubles when it is full: short queues that are used all the
/// time, for which std::deque's blocks are far apart.
template <class T>
class Fifo {
 public:
  bool empty() const { return head_ == tail_; }
  std::size_t size() const { return tail_ - head_; }
  /// Only when not empty, as pop_front().
  const T& front() const { return items_[head_ & (items_.size() - 1)]; }
  /// i < size(), from the front.
  const T& operator[](std::size_t i) const { return items_[(head_ + i) & (items_.size() - 1)]; }
  void pop_front() { ++head_; }
  void push_back(T item) {
    if (size() == items_.size()) grow();
    items_[tail_++ & (items_.size() - 1)] = std::move(item);
  }

 private:
  [[gnu::cold, gnu::noinline]] void grow() {
    std::vector<T> larger(2 * items_.size());
    for (std::size_t i = 0; i < size(); ++i) larger[i] = std::move(items_[(head_ + i) & (items_.size() - 1)]);
    tail_ = size();
    head_ = 0;
    items_ = std::move(larger);
  }

  std::vector<T> items_ = std::vector<T>(2);  // their number is a power of two
  std::size_t head_ = 0, tail_ = 0;           // ever growing
};

}  // namespace carousel::ringbus
