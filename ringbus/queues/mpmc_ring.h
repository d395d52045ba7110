#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "ringbus/queues/link_queue.h"

namespace carousel::ringbus {

/// A ring whose cells carry sequence numbers, for any number of producers and consumers (D. Vyukov, "Bounded MPMC
/// queue", 1024cores.net, 2010). A push takes the next ticket by compare-and-swap only after it has seen the ticket's
/// cell free, so nobody waits for anybody: a preempted producer holds up pops of what lies behind it (they are
/// refused), never a thread.
///
/// Beyond Vyukov's: batches take consecutive tickets with one compare-and-swap; any capacity down to 1 works, since
/// the numbers tell "free for ticket p" (2p) from "holds ticket p" (2p + 1). With numbers p and p + 1, as published,
/// one cell that holds ticket p looks free for ticket p + 1.
template <class T>
class MpmcRing {
 public:
  static constexpr Parties kProducers = Parties::kMany;
  static constexpr Parties kConsumers = Parties::kMany;

  explicit MpmcRing(std::size_t capacity)
      : capacity_(capacity),
        mask_(std::has_single_bit(capacity) ? capacity - 1 : 0),
        cells_(std::make_unique<Cell[]>(capacity)) {
    // Relaxed: nobody else has the queue yet.
    for (std::size_t i = 0; i < capacity; ++i) cells_[i].number.store(2 * i, std::memory_order_relaxed);
  }

  bool try_push(const T& value) { return try_push_n({&value, 1}) == 1; }
  bool try_pop(T& value) { return try_pop_n({&value, 1}) == 1; }

  std::size_t try_push_n(std::span<const T> values) {
    std::uint64_t first;
    const std::size_t count = claim(tail_.ticket, 0, values.size(), first);
    for (std::size_t i = 0; i < count; ++i) {
      Cell& cell = at(first + i);
      cell.value = values[i];
      // Release: pairs with the acquire in claim() of the pop; whoever sees the number sees the value.
      cell.number.store(2 * (first + i) + 1, std::memory_order_release);
    }
    return count;
  }

  std::size_t try_pop_n(std::span<T> values) {
    std::uint64_t first;
    const std::size_t count = claim(head_.ticket, 1, values.size(), first);
    for (std::size_t i = 0; i < count; ++i) {
      Cell& cell = at(first + i);
      values[i] = cell.value;
      // Release: pairs with the acquire in claim() of the push that uses the cell next; the value has been read.
      cell.number.store(2 * (first + i + capacity_), std::memory_order_release);
    }
    return count;
  }

  /// Counts the free cells, so it takes longer the more of them there are.
  std::size_t free_places() {
    // Relaxed: exact for the only producer, which wrote it itself.
    const std::uint64_t first = tail_.ticket.load(std::memory_order_relaxed);
    std::size_t count = 0;
    // Acquire: as in claim(), since a push may rely on the answer.
    while (count < capacity_ && at(first + count).number.load(std::memory_order_acquire) == 2 * (first + count))
      ++count;
    return count;
  }
  std::size_t capacity() const { return capacity_; }

 private:
  struct Cell {
    std::atomic<std::uint64_t> number;  // 2p: free for the push with ticket p; 2p + 1: holds what it pushed
    T value;
  };
  // A line pair each: producers and consumers write them at the same time. Cells are not padded: at 8 bytes a message
  // four to a line lost less to sharing than one to a line lost to traffic.
  struct alignas(128) Tickets {
    std::atomic<std::uint64_t> ticket{0};
  };

  Cell& at(std::uint64_t ticket) { return cells_[mask_ != 0 ? ticket & mask_ : ticket % capacity_]; }

  /// Takes up to `want` tickets in a row whose cells have come to their turn (`holds`: 0 free, 1 full).
  std::size_t claim(std::atomic<std::uint64_t>& next, std::uint64_t holds, std::size_t want, std::uint64_t& first) {
    // Relaxed: only a guess of the next ticket; the cell's number and the compare-and-swap decide.
    first = next.load(std::memory_order_relaxed);
    want = std::min(want, capacity_);
    while (want > 0) {
      std::size_t count = 0;
      std::uint64_t number = 0;
      for (; count < want; ++count) {
        // Acquire: pairs with the release of the call that used the cell before.
        number = at(first + count).number.load(std::memory_order_acquire);
        if (number != 2 * (first + count) + holds) break;
      }
      if (count == 0) {
        // The cell is still in use from the round before: full, or empty.
        if (number < 2 * first + holds) return 0;
        first = next.load(std::memory_order_relaxed);  // another thread has been quicker
      } else if (next.compare_exchange_weak(first, first + count, std::memory_order_relaxed)) {
        // Relaxed: a ticket carries no data; the cells' numbers do.
        return count;
      }
    }
    return 0;
  }

  Tickets tail_, head_;
  alignas(128) std::size_t capacity_;  // read by all, written by none
  std::size_t mask_;                   // 0 where the capacity is no power of two
  std::unique_ptr<Cell[]> cells_;
};

}  // namespace carousel::ringbus
