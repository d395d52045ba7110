#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "ringbus/cycle/time/clock.h"
#include "ringbus/rays/ray_id.h"

namespace carousel::ringbus::cycle {

/// A one-way channel from one agent to another: things with the time at which they arrive, in sending order. Arrival
/// times must not decrease (checked builds throw a std::logic_error). The two agents may live on different threads: a
/// thing that is sent within a window arrives after it (see windows.h), so nothing changes if the receiver sees it a
/// little earlier.
///
/// If a T has bytes(), the size of the message that it stands for, both ends count them.
///
/// Things stand in a chain of blocks; the block that the receiver has emptied goes back to the sender.
template <class T>
class Channel {
 public:
  Channel() : head_block_(new Block), tail_block_(head_block_) {}
  ~Channel() {
    delete spare_.load(std::memory_order_relaxed);
    while (head_block_ != nullptr) delete std::exchange(head_block_, head_block_->next);
  }
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;

  void send(Cycle arrival, T thing) {
    if constexpr (kChecked) {
      if (arrival < last_sent_) throw std::logic_error("a channel's arrivals go back in time");
      last_sent_ = arrival;
    }
    const std::size_t tail = tail_.load(std::memory_order_relaxed), place = tail % kBlock;
    if (place == 0 && tail > 0) {
      // Acquire: the receiver has done with the block it gave back.
      Block* block = spare_.exchange(nullptr, std::memory_order_acquire);
      if (block == nullptr) block = new Block;
      block->next = nullptr;
      tail_block_->next = block;
      tail_block_ = block;
    }
    if constexpr (kHasBytes) bytes_sent_ += thing.bytes();
    tail_block_->items[place] = {arrival, std::move(thing)};
    tail_.store(tail + 1, std::memory_order_release);  // publishes the item, and the block's link
    if (arrival < *wake_) *wake_ = arrival;
  }
  /// From now on `slot` keeps the earliest arrival that was sent since it was last cleared. The sender writes it.
  void wakes(Cycle& slot) { wake_ = &slot; }

  /// Arrival of the first thing; kNever when there is none.
  Cycle next() const {
    if (arrival_ == kNever && head_ != tail_.load(std::memory_order_acquire)) arrival_ = first().arrival;
    return arrival_;
  }
  /// Only when next() is not kNever, as take().
  const T& front() const { return first().thing; }
  T take() {
    T thing = std::move(const_cast<Item&>(first()).thing);
    arrival_ = kNever;
    if constexpr (kHasBytes) bytes_taken_ += thing.bytes();
    if (++head_ % kBlock == 0) emptied_ = true;
    return thing;
  }
  /// Takes all that has arrived by `now`, where what arrives says nothing but that it does. Returns how many these
  /// were.
  std::size_t take_until(Cycle now) requires std::is_empty_v<T> {
    const std::size_t end = tail_.load(std::memory_order_acquire), begin = head_;
    while (head_ != end) {
      arrival_ = first().arrival;
      if (arrival_ > now) break;
      arrival_ = kNever;
      if (++head_ % kBlock == 0) emptied_ = true;
    }
    return head_ - begin;
  }
  /// How many have arrived by `now`.
  std::size_t arrived(Cycle now) const {
    const std::size_t end = tail_.load(std::memory_order_acquire);
    if (head_ == end) return 0;
    first();  // the head block is the one that holds it
    const Block* block = head_block_;
    std::size_t at = head_;
    for (; at != end; ++at) {
      if (at != head_ && at % kBlock == 0) block = block->next;
      if (block->items[at % kBlock].arrival > now) break;
    }
    return at - head_;
  }
  /// The arrival of the first thing that comes after `now`; kNever while none is known.
  Cycle next_after(Cycle now) const {
    const std::size_t known = size();
    for (std::size_t place = 0; place < known; ++place)
      if (item(place).arrival > now) return item(place).arrival;
    return kNever;
  }
  /// The thing that stands `place` behind the first; only if there is one.
  const T& peek(std::size_t place) const { return item(place).thing; }
  /// It has arrived, and comes to stand before the others.
  void bring_forward(std::size_t place) {
    for (; place > 0; --place) std::swap(item(place), item(place - 1));
    arrival_ = kNever;
  }
  /// In all, as the sender and the receiver have counted; while no agent runs. `waiting` are those that have been sent
  /// and not taken.
  struct Count {
    std::uint64_t sent = 0, taken = 0, waiting = 0;
  };
  std::uint64_t bytes_sent() const { return bytes_sent_; }  ///< for the sender
  Count messages() const { return {tail_.load(std::memory_order_acquire), head_, size()}; }
  Count bytes() const {
    Count count{bytes_sent_, bytes_taken_, 0};
    if constexpr (kHasBytes) {
      if (size() > 0) first();  // the head block is the one that holds it
      const Block* block = head_block_;
      for (std::size_t at = head_, end = head_ + size(); at != end; ++at) {
        if (at != head_ && at % kBlock == 0) block = block->next;
        count.waiting += block->items[at % kBlock].thing.bytes();
      }
    }
    return count;
  }
  std::size_t size() const { return tail_.load(std::memory_order_acquire) - head_; }

 private:
  static constexpr bool kHasBytes = requires(const T& thing) { std::uint64_t{thing.bytes()}; };
  static constexpr std::size_t kBlock = 16;
  struct Item {
    Cycle arrival = 0;
    [[no_unique_address]] T thing{};
  };
  struct Block {
    std::array<Item, kBlock> items;
    Block* next = nullptr;
  };

  const Item& first() const {
    if (emptied_) [[unlikely]] {
      // There is a first thing, so the next block has been linked.
      Block* block = std::exchange(head_block_, head_block_->next);
      delete spare_.exchange(block, std::memory_order_release);
      emptied_ = false;
    }
    return head_block_->items[head_ % kBlock];
  }

  /// The sender does not touch what it has published.
  Item& item(std::size_t place) const {
    first();  // the head block is the one that holds it
    Block* block = head_block_;
    for (std::size_t at = head_ / kBlock; at != (head_ + place) / kBlock; ++at) block = block->next;
    return block->items[(head_ + place) % kBlock];
  }

  // Used by the receiver.
  alignas(64) mutable Block* head_block_;
  std::size_t head_ = 0;
  std::uint64_t bytes_taken_ = 0;
  mutable Cycle arrival_ = kNever;  // of the first thing, once it has been looked at
  mutable bool emptied_ = false;    // the head block has been read to its end, and the next one not begun
  // Used by the sender.
  alignas(64) Block* tail_block_;
  std::atomic<std::size_t> tail_{0};
  std::uint64_t bytes_sent_ = 0;
  Cycle last_sent_ = 0;  // arrival of the last thing, in checked builds
  Cycle unconnected_ = kNever;
  Cycle* wake_ = &unconnected_;
  mutable std::atomic<Block*> spare_{nullptr};  // used by both, but only once a block
};

}  // namespace carousel::ringbus::cycle
