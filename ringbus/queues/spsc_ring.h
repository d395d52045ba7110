#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <memory>
#include <span>

#include "ringbus/queues/link_queue.h"

namespace carousel::ringbus {

/// Lamport's single-producer single-consumer ring (Lamport, "Proving the correctness of multiprocess programs", 1977)
/// whose producer's index travels with the data: what a push publishes is one run of cells, and the first cell of the
/// run holds the index after it. So a message and the news of it come with one cache line where an index of its own
/// costs a second (Giacomoni, Moseley, Vachharajani, "FastForward for efficient pipeline parallelism", PPoPP 2008, mark
/// every cell), and a run of 32 is announced once. The consumer's index is cached by the producer (Lee, Bu,
/// Chandranmenon, MCRingBuffer, 2010). Indices count on and never wrap in practice (2^64).
template <class T>
class SpscRing {
 public:
  static constexpr Parties kProducers = Parties::kOne;
  static constexpr Parties kConsumers = Parties::kOne;

  /// `capacity` >= 1; storage is rounded up to a power of two, the capacity is not.
  explicit SpscRing(std::size_t capacity)
      : capacity_(capacity), mask_(std::bit_ceil(capacity) - 1), cells_(std::make_unique<Cell[]>(mask_ + 1)) {}

  /// Producer only.
  bool try_push(const T& value) { return try_push_n({&value, 1}) == 1; }

  /// Producer only.
  std::size_t try_push_n(std::span<const T> values) {
    const std::size_t tail = producer_.index;
    if (capacity_ - (tail - producer_.other) < values.size()) look_for_room();
    const std::size_t count = std::min(values.size(), capacity_ - (tail - producer_.other));
    if (count == 0) return 0;
    for (std::size_t i = 0; i < count; ++i) cell(tail + i).value = values[i];
    producer_.index = tail + count;
    // Release: pairs with the acquire in published_to; whoever sees the run's end sees its cells.
    cell(tail).run_end.store(tail + count, std::memory_order_release);
    return count;
  }

  /// Consumer only.
  bool try_pop(T& value) { return try_pop_n({&value, 1}) == 1; }

  /// Consumer only.
  std::size_t try_pop_n(std::span<T> values) {
    std::size_t head = consumer_.index, count = 0;
    while (count < values.size()) {
      if (head == consumer_.other && (consumer_.other = published_to(head)) == head) break;
      const std::size_t end = std::min(consumer_.other, head + (values.size() - count));
      while (head < end) values[count++] = cell(head++).value;
    }
    if (count == 0) return 0;
    consumer_.index = head;
    // Release: pairs with the acquire in look_for_room; the cells may be overwritten now.
    taken_.index.store(head, std::memory_order_release);
    return count;
  }

  /// Producer only.
  std::size_t free_places() {
    look_for_room();
    return capacity_ - (producer_.index - producer_.other);
  }
  std::size_t capacity() const { return capacity_; }

 private:
  struct Cell {
    std::atomic<std::size_t> run_end{0};  // end of the run that began here when it was last written as a first cell
    T value{};
  };
  // A line pair each: the two sides write at the same time, and the prefetcher fetches lines in pairs.
  struct alignas(128) Side {
    std::size_t index = 0;  // how many this side has pushed, or popped
    std::size_t other = 0;  // the other side's index, as far as this side knows it
  };
  struct alignas(128) Shared {
    std::atomic<std::size_t> index{0};
  };

  Cell& cell(std::size_t index) { return cells_[index & mask_]; }

  // Acquire: pairs with the release in try_pop_n; cells seen as free have been read.
  void look_for_room() { producer_.other = taken_.index.load(std::memory_order_acquire); }

  /// The end of the run that begins at `head`, where the run before it has ended; `head` while there is none. The
  /// index that the cell holds from a lap before is at most `head`: that run began a lap or more earlier and was at
  /// most as long as the capacity.
  std::size_t published_to(std::size_t head) {
    // Acquire: pairs with the release in try_push_n.
    return std::max(head, cell(head).run_end.load(std::memory_order_acquire));
  }

  Side producer_;                      // the producer's own
  Side consumer_;                      // the consumer's own
  Shared taken_;                       // the consumer's index, for the producer to see
  alignas(128) std::size_t capacity_;  // read by both, written by none
  std::size_t mask_;
  std::unique_ptr<Cell[]> cells_;
};

}  // namespace carousel::ringbus
