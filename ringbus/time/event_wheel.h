#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <queue>
#include <vector>

#include "core/numeric/grow.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus {

/// Events of things that are numbered from 0 on, at most one a thing: taken in order of time, and at one time in the
/// order in which they were added. Most events are a few cycles away, and cost the same however many there are: they
/// stand in a list for each of the next cycles (G. Varghese, A. Lauck, Hashed and hierarchical timing wheels, SOSP
/// 1987). The few that are further away wait in a heap.
class EventWheel {
 public:
  /// Adds an event at `at`. `now` is not later than `at`, and not earlier than the last event taken.
  void add(Cycle now, Cycle at, std::uint32_t thing) {
    if (next_ == kNever) base_ = now;
    grow_to(link_, thing + std::size_t{1});
    if (at - base_ < kSlots)
      append(at, thing);
    else
      add_far(at, thing);
    if (at < next_) next_ = at;
  }
  /// The time of the first event; kNever when there is none.
  Cycle next() const { return next_; }
  /// Only when next() is not kNever.
  std::uint32_t take() {
    if (next_ != base_) turn_to(next_);
    List& list = lists_[next_ % kSlots];
    const std::uint32_t thing = list.first;
    list.first = link_[thing];
    if (list.first != kNone) return thing;
    filled_ &= ~(std::uint64_t{1} << next_ % kSlots);
    next_ = find();
    return thing;
  }

 private:
  static constexpr Cycle kSlots = 64;
  static constexpr std::uint32_t kNone = ~0u;
  struct List {
    std::uint32_t first = kNone, last = kNone;
  };
  struct Far {
    Cycle at = 0;
    std::uint64_t turn = 0;
    std::uint32_t thing = 0;
    bool operator>(const Far& o) const { return at != o.at ? at > o.at : turn > o.turn; }
  };

  void append(Cycle at, std::uint32_t thing) {
    List& list = lists_[at % kSlots];
    if (list.first == kNone)
      list.first = thing;
    else
      link_[list.last] = thing;
    list.last = thing;
    link_[thing] = kNone;
    filled_ |= std::uint64_t{1} << at % kSlots;
  }
  [[gnu::noinline]] void add_far(Cycle at, std::uint32_t thing) { far_.push({at, next_turn_++, thing}); }
  /// No event is earlier. Brings in those that are no longer far, before any that are added from now on.
  void turn_to(Cycle now) {
    base_ = now;
    if (!far_.empty()) bring_in();
  }
  [[gnu::noinline]] void bring_in() {
    for (; !far_.empty() && far_.top().at - base_ < kSlots; far_.pop()) append(far_.top().at, far_.top().thing);
  }
  Cycle find() const {
    if (filled_ == 0) return far_.empty() ? kNever : far_.top().at;
    return base_ + static_cast<Cycle>(std::countr_zero(std::rotr(filled_, static_cast<int>(base_ % kSlots))));
  }

  std::array<List, kSlots> lists_;   // one for each cycle from base_ on, at its time modulo kSlots
  std::uint64_t filled_ = 0;         // a bit for each list that is not empty
  std::vector<std::uint32_t> link_;  // by thing: the next one in its list
  std::priority_queue<Far, std::vector<Far>, std::greater<>> far_;
  std::uint64_t next_turn_ = 0;
  Cycle base_ = 0, next_ = kNever;
};

}  // namespace carousel::ringbus
