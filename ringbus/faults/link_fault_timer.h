#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <utility>

#include "ringbus/faults/fault_injector.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// Computes, in virtual time, when a packet arrives over a link with faults and when its sender learns of it.
///
/// With go-back-N all frames behind a lost one are sent again after it, so the link counts as busy until the lost one
/// has got through. An acknowledgement brings the credit back, the place at the receiver, and fails like a frame. As
/// acknowledgements are cumulative, the next one recovers a lost one. If there is none, the sender sends the last frame
/// again after a time, to which the receiver only answers.
class LinkFaultTimer {
 public:
  /// `crossings`: of a round trip, between the clocks of the link and its ends. All times are by that of the link.
  LinkFaultTimer(const FaultsConfig::Links& links, std::int64_t seed, std::uint64_t link, Cycle latency,
                 Cycle crossings = 0)
      : injector_(links, seed, 2 * link),
        ack_injector_(links, seed, 2 * link + 1),
        delay_(static_cast<Cycle>(links.delay_cycles)),
        latency_(latency),
        crossings_(crossings) {}

  struct Delivery {
    Cycle arrival = 0;    ///< arrival of the head
    Cycle link_free = 0;  ///< when the next one may start
    Cycle busy = 0;       ///< for which the link moved something
  };
  /// A packet of `cycles` that starts `now`.
  Delivery send(Cycle now, Cycle cycles) {
    cycles_ = cycles;
    Delivery out;
    Cycle start = now;
    for (bool first = true;; first = false) {
      counts_.resent += !first;
      const FaultDraw faults = injector_.next(counts_);
      out.busy += cycles * (faults.duplicate && !faults.drop ? 2 : 1);
      counts_.discarded += faults.duplicate && !faults.drop;
      // It arrives before the frame that it overtook, so the receiver discards it.
      const bool early = std::exchange(overtaken_, false) && first;
      if (faults.drop || faults.corrupt || early) {
        counts_.discarded += !faults.drop;
        start += cycles + round_trip();
        continue;
      }
      overtaken_ = faults.reorder;
      out.link_free = start + cycles * (faults.duplicate ? 2 : 1);
      out.arrival = start + latency_ + (faults.delay ? delay_ : 0) + (faults.reorder ? cycles : 0);
      break;
    }
    // Frames arrive in order, however late one is.
    last_ = out.arrival = std::max(out.arrival, last_);
    return out;
  }

  /// Takes the acknowledgement that would come at `at`, no earlier than any before. Returns how many places the sender
  /// now knows to be free again. Call recovered(at) before.
  std::uint32_t acknowledge(Cycle at) {
    const FaultDraw faults = ack_injector_.next(counts_);
    const bool lost = faults.drop || faults.corrupt;
    if (lost || faults.delay || faults.reorder) {
      // An acknowledgement that was overtaken says nothing new when it comes.
      overdue_.push_back(lost || faults.reorder ? kNever : at + delay_);
      if (repeat_at_ == kNever) repeat_at_ = at + round_trip();
      return 0;
    }
    return learn(overdue_.size()) + 1;
  }
  /// The places that late acknowledgements and repeated frames have brought back.
  struct Recovered {
    std::uint32_t places = 0;
    Cycle busy = 0;  ///< in which the link carried repeated frames
  };
  Recovered recovered(Cycle now) {
    Recovered out;
    while (!overdue_.empty()) {
      const auto first = std::min_element(overdue_.begin(), overdue_.end());
      if (std::min(*first, repeat_at_) > now) break;
      if (*first <= repeat_at_)
        out.places += learn(static_cast<std::size_t>(first - overdue_.begin()) + 1);
      else
        out.busy += repeat();
    }
    return out;
  }
  /// The next time at which recovered() may bring something.
  Cycle next() const {
    if (overdue_.empty()) return kNever;
    return std::min(*std::min_element(overdue_.begin(), overdue_.end()), repeat_at_);
  }
  const LinkFaultCounts& counts() const { return counts_; }

 private:
  /// The time after which an answer would be there.
  Cycle round_trip() const { return 2 * latency_ + crossings_ + cycles_; }
  std::uint32_t learn(std::size_t count) {
    overdue_.erase(overdue_.begin(), overdue_.begin() + static_cast<std::ptrdiff_t>(count));
    if (overdue_.empty()) repeat_at_ = kNever;
    return static_cast<std::uint32_t>(count);
  }
  /// Sends the last frame once more. The acknowledgement comes with the answer, if both get through.
  Cycle repeat() {
    ++counts_.resent;
    const FaultDraw frame = ack_injector_.next(counts_);
    counts_.discarded += !frame.drop;
    const bool through = !frame.drop && !frame.corrupt;
    const FaultDraw answer = through ? ack_injector_.next(counts_) : FaultDraw{};
    if (through && !answer.drop && !answer.corrupt)
      overdue_.back() = std::min(overdue_.back(),
                                 repeat_at_ + round_trip() + (frame.delay ? delay_ : 0) + (answer.delay ? delay_ : 0));
    repeat_at_ += cycles_ + round_trip();
    return cycles_;
  }

  FaultInjector injector_, ack_injector_;
  Cycle delay_, latency_, crossings_;
  Cycle cycles_ = 1;  // length of the last packet
  Cycle last_ = 0;
  bool overtaken_ = false;     // the frame before comes after the next one
  std::deque<Cycle> overdue_;  // when the acknowledgements that are overdue come, or never
  Cycle repeat_at_ = kNever;   // while some are overdue
  LinkFaultCounts counts_;
};

}  // namespace carousel::ringbus::cycle
