#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/statistics/queue_use.h"
#include "ringbus/queues/index_queue.h"
#include "ringbus/schedule/schedule.h"

namespace carousel::ringbus {

/// A bounded queue of pieces of data that are too large to be copied through one: as many pieces as it has places go
/// round, filled from producers to consumers and empty back. A producer that finds none empty is refused, and keeps
/// what it has.
///
/// Two queues of one design carry the indices, so whoever is a producer of the one is a consumer of the other, and
/// the design has to serve as many threads on each side as there are producers, and consumers, at a time.
template <class T>
class PooledQueue {
 public:
  PooledQueue(QueueKind kind, std::size_t places)
      : pieces_(places), full_(make_index_queue(kind, places)), empty_(make_index_queue(kind, places)) {
    for (std::uint32_t i = 0; i < places; ++i) insist(*empty_, i);
  }

  /// For producers: an empty piece that is theirs until they push() it; null, and a refusal is counted, if all are in
  /// use.
  T* try_take() {
    std::uint32_t index;
    if (empty_->try_pop(index)) return &pieces_[index];
    refusals_.fetch_add(1, std::memory_order_relaxed);
    return nullptr;
  }
  /// `rays`: how many it has, for the statistics.
  void push(T* piece, std::size_t rays) {
    // Relaxed: these are sums for the report; the queue publishes the piece.
    rays_.fetch_add(rays, std::memory_order_relaxed);
    const std::uint64_t sent = sent_.fetch_add(1, std::memory_order_relaxed) + 1;
    const std::uint64_t taken = taken_.load(std::memory_order_relaxed);
    const std::uint64_t waiting = sent > taken ? sent - taken : 0;
    waiting_sum_.fetch_add(waiting, std::memory_order_relaxed);
    for (std::uint64_t most = waiting_most_.load(std::memory_order_relaxed);
         most < waiting && !waiting_most_.compare_exchange_weak(most, waiting, std::memory_order_relaxed);) {
    }
    insist(*full_, index_of(piece));
  }
  /// For consumers: the next full piece, theirs until they give_back() it; null if there is none.
  T* try_pop() {
    std::uint32_t index;
    if (!full_->try_pop(index)) return nullptr;
    taken_.fetch_add(1, std::memory_order_relaxed);
    return &pieces_[index];
  }
  /// The piece is empty again; its storage may stay.
  void give_back(T* piece) { insist(*empty_, index_of(piece)); }

  /// Any thread may call; exact when no other one uses the queue.
  QueueUse use() const {
    return {pieces_.size(), sent_.load(), rays_.load(), refusals_.load(), waiting_sum_.load(), waiting_most_.load()};
  }

 private:
  std::uint32_t index_of(const T* piece) const { return static_cast<std::uint32_t>(piece - pieces_.data()); }
  // There is a place for every index. A queue may still refuse one while another thread's pop is not over.
  static void insist(IndexQueue& queue, std::uint32_t index) {
    while (!queue.try_push(index)) schedule_pause();
  }

  std::vector<T> pieces_;
  std::unique_ptr<IndexQueue> full_, empty_;
  // A line pair for each side.
  alignas(128) std::atomic<std::uint64_t> sent_{0}, rays_{0}, refusals_{0}, waiting_sum_{0}, waiting_most_{0};
  alignas(128) std::atomic<std::uint64_t> taken_{0};
};

}  // namespace carousel::ringbus
