#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "ringbus/rays/ray_id.h"
#include "ringbus/time/channel_list.h"
#include "ringbus/time/clock_ratio.h"

namespace carousel::ringbus {

/// A one-way channel from one agent to another: things with the time at which they arrive, in sending order. Arrival
/// times must not decrease (checked builds throw a std::logic_error). The two agents may live on different threads: a
/// thing that is sent within a window arrives after it (see windows.h), so nothing changes if the receiver sees it a
/// little earlier.
///
/// If a T has bytes(), the size of the message that it stands for, both ends count them; if not, the kind of message
/// says the size of all (channel_list.h).
///
/// With `Returns` the receiver gives each thing's place back when it takes the thing, and the sender learns of that at
/// a time that the receiver names: the credits of a link, without a second channel.
///
/// Things stand in blocks that form a circle, so that the same few are used again and again. The sender puts a new one
/// in when the next is still in use, and takes one out when there are too many; the receiver only follows.
template <class T, bool Returns = false>
class Channel : public AnyChannel {
 public:
  /// Enters itself into the list of its machine.
  explicit Channel(const ChannelPlace& place) {
    place.list.add(*this, place.kind, place.ends, kHasBytes);
    Block* block = new Block;
    block->next = block;
    head_ = tail_ = {block, block->items.data()};
    if constexpr (Returns) returns_.at = head_;
  }
  ~Channel() override {
    for (Block* block = std::exchange(head_.block->next, nullptr); block != nullptr;)
      delete std::exchange(block, block->next);
  }

  /// The two agents go by different clocks: times that one names are told to the other by its own, after a
  /// synchroniser. `there`: from the clock by which arrivals are named to the receiver's; `back`: from the clock by
  /// which returns are named to the sender's. Before the start.
  void cross(const ClockRatio& there, const ClockRatio& back) {
    if (!there.equal()) there_ = std::make_unique<const ClockRatio>(there);
    if (!back.equal()) returns_by_ = std::make_unique<const ClockRatio>(back);
  }

  void send(Cycle arrival, T thing) requires(!Returns) { put(arrival, std::move(thing)); }
  /// Inlined, as most of what a network does is that packets pass.
  [[gnu::always_inline]] void send(Cycle arrival, const T& thing) requires Returns { put(arrival, thing); }
  void wakes(Cycle& slot) override { wake_ = &slot; }

  /// Arrival of the first thing; kNever when there is none.
  Cycle next() const {
    if (arrival_ == kNever && size() > 0) arrival_ = head_.item->arrival;
    return arrival_;
  }
  /// Only when next() is not kNever, as take().
  const T& front() const { return head_.item->thing; }
  T take() requires(!Returns) { return take_first(); }
  /// The sender learns at `back` that the thing has been taken; no earlier than of any before (checked builds throw a
  /// std::logic_error).
  T take(Cycle back) requires Returns {
    if (returns_by_ != nullptr) [[unlikely]]
      back = entered(*returns_by_, back);
    if constexpr (kChecked) {
      if (back < last_back_) throw std::logic_error("a channel's places come back in another order");
      last_back_ = back;
    }
    head_.item->back = back;
    return take_first();
  }
  /// How many have arrived by `now`.
  std::size_t arrived(Cycle now) const {
    const std::size_t known = size();
    std::size_t count = 0;
    while (count < known && item(count).arrival <= now) ++count;
    return count;
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

  /// For the sender: when it learns of the first place that it has not heard of; kNever while none is known.
  Cycle next_return() const requires Returns {
    if (returns_.next == kNever && returns_.count != taken_.load(std::memory_order_acquire))
      returns_.next = returns_.at.item->back;
    return returns_.next;
  }
  /// For the sender: hears of all places of which it learns by `now`. Returns how many these are.
  std::uint32_t take_returns(Cycle now) requires Returns {
    if (next_return() > now) return 0;
    const std::size_t before = returns_.count, taken = taken_.load(std::memory_order_acquire);
    do take_return();
    while (returns_.count != taken && returns_.at.item->back <= now);
    return static_cast<std::uint32_t>(returns_.count - before);
  }
  /// Hears of the next one; only when next_return() is not kNever.
  void take_return() requires Returns {
    returns_.next = kNever;
    returns_.at.advance(++returns_.count);
  }

  std::uint64_t bytes_sent() const final { return bytes_sent_; }
  Count messages() const override {
    return {sent_.load(std::memory_order_acquire), taken_.load(std::memory_order_acquire), size()};
  }
  Count bytes() const override {
    Count count{bytes_sent_, bytes_taken_, 0};
    if constexpr (kHasBytes) {
      for (std::size_t place = 0; place < size(); ++place) count.waiting += item(place).thing.bytes();
    }
    return count;
  }
  /// For the receiver.
  std::size_t size() const { return sent_.load(std::memory_order_acquire) - taken_.load(std::memory_order_relaxed); }

 private:
  static constexpr bool kHasBytes = requires(const T& thing) { std::uint64_t{thing.bytes()}; };
  static constexpr std::size_t kBlock = 16;
  struct Nothing {};
  struct Item {
    Cycle arrival = 0;
    [[no_unique_address]] std::conditional_t<Returns, Cycle, Nothing> back{};
    [[no_unique_address]] T thing{};
  };
  struct Block {
    std::array<Item, kBlock> items;
    Block* next = nullptr;
  };

  /// A place in the circle.
  struct Cursor {
    Block* block = nullptr;
    Item* item = nullptr;
    /// `passed`: the items before the new place.
    void advance(std::size_t passed) {
      if (passed % kBlock != 0) [[likely]] {
        ++item;
      } else {
        block = block->next;
        item = block->items.data();
      }
    }
  };
  /// The places that the sender knows to have come back.
  struct Heard {
    Cursor at;  // the first place that it does not know of
    std::size_t count = 0;
    Cycle next = kNever;  // when it learns of that place, once it has been looked at
  };

  /// Out of line, as few channels have two clocks.
  [[gnu::cold, gnu::noinline]] static Cycle entered(const ClockRatio& clock, Cycle at) { return clock.enter(at); }
  template <class Thing>
  [[gnu::always_inline]] void put(Cycle arrival, Thing&& thing) {
    if (there_ != nullptr) [[unlikely]]
      arrival = entered(*there_, arrival);
    if constexpr (kChecked) {
      if (arrival < last_sent_) throw std::logic_error("a channel's arrivals go back in time");
      last_sent_ = arrival;
    }
    if constexpr (kHasBytes) bytes_sent_ += thing.bytes();
    const std::size_t sent = sent_.load(std::memory_order_relaxed) + 1;
    tail_.item->arrival = arrival;
    tail_.item->thing = std::forward<Thing>(thing);
    if (sent % kBlock == 0) [[unlikely]]
      begin_block(sent);
    else
      ++tail_.item;
    sent_.store(sent, std::memory_order_release);  // publishes the item, and what follows its block
    if (arrival < *wake_) *wake_ = arrival;
  }
  Item& item(std::size_t place) const {
    const std::size_t taken = taken_.load(std::memory_order_relaxed);
    Block* block = head_.block;
    for (std::size_t at = taken / kBlock; at != (taken + place) / kBlock; ++at) block = block->next;
    return block->items[(taken + place) % kBlock];
  }
  T take_first() {
    T thing = std::move(head_.item->thing);
    arrival_ = kNever;
    if constexpr (kHasBytes) bytes_taken_ += thing.bytes();
    const std::size_t taken = taken_.load(std::memory_order_relaxed) + 1;
    head_.advance(taken);
    taken_.store(taken, std::memory_order_release);  // publishes the return, and that the block is done with
    return thing;
  }
  /// The sender has filled its block up to the thing of number `end`, and goes on in the next one.
  [[gnu::noinline]] void begin_block(std::size_t end) {
    std::size_t done = taken_.load(std::memory_order_acquire);
    if constexpr (Returns) done = returns_.count;
    // The n-th block from here on: its last thing was the one of number end - (blocks_ - n) * kBlock, a round ago.
    const auto unused = [&](std::size_t n) { return n < blocks_ && done + (blocks_ - n) * kBlock >= end; };
    Block* block = tail_.block;
    if (!unused(1)) {
      block->next = new Block{{}, block->next};
      ++blocks_;
    } else if (unused(3)) {
      delete std::exchange(block->next, block->next->next);
      --blocks_;
    }
    tail_.advance(end);
  }

  // Used by the receiver, and `taken_` read by the sender.
  alignas(64) Cursor head_;
  std::atomic<std::size_t> taken_{0};
  std::uint64_t bytes_taken_ = 0;
  mutable Cycle arrival_ = kNever;                // arrival of the first thing, once it has been looked at
  Cycle last_back_ = 0;                           // `back` of the last thing taken, in checked builds
  std::unique_ptr<const ClockRatio> returns_by_;  // null: one clock
  // Used by the sender, and `sent_` read by the receiver.
  alignas(64) Cursor tail_;
  std::atomic<std::size_t> sent_{0};
  std::uint64_t bytes_sent_ = 0;
  Cycle* wake_ = &unconnected_;
  std::unique_ptr<const ClockRatio> there_;  // null: one clock
  std::size_t blocks_ = 1;
  Cycle unconnected_ = kNever;
  Cycle last_sent_ = 0;  // arrival of the last thing, in checked builds; behind the line of what sending needs
  [[no_unique_address]] mutable std::conditional_t<Returns, Heard, Nothing> returns_;
};

}  // namespace carousel::ringbus
