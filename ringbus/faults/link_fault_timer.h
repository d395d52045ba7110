#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <utility>

#include "ringbus/cycle/time/clock.h"
#include "ringbus/faults/fault_injector.h"

namespace carousel::ringbus::cycle {

/// When a packet gets over a link that fails, and when its sender knows, in virtual time.
///
/// With go-back-N everything behind a lost frame is sent again after it, so what is behind counts from the moment the
/// lost one has got through: the link is as good as busy until then. An acknowledgement is what brings the place at the
/// receiver back, the credit. It fails like a frame. As acknowledgements are cumulative, the next one makes a lost one
/// good; if there is none, the sender asks after a time by sending the frame again, of which the receiver needs no more
/// than that it answers.
class LinkFaultTimer {
 public:
  LinkFaultTimer(const FaultsConfig::Links& links, std::int64_t seed, std::uint64_t link, Cycle latency)
      : injector_(links, seed, 2 * link),
        ack_injector_(links, seed, 2 * link + 1),
        delay_(static_cast<Cycle>(links.delay_cycles)),
        latency_(latency) {}

  struct Delivery {
    Cycle arrival = 0;    ///< of the head
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
      const FaultDraw fate = injector_.next(counts_);
      out.busy += cycles * (fate.duplicate && !fate.drop ? 2 : 1);
      counts_.discarded += fate.duplicate && !fate.drop;
      // It comes before the one that was overtaken, and is not taken.
      const bool early = std::exchange(overtaken_, false) && first;
      if (fate.drop || fate.corrupt || early) {
        counts_.discarded += !fate.drop;
        start += cycles + patience();
        continue;
      }
      overtaken_ = fate.reorder;
      out.link_free = start + cycles * (fate.duplicate ? 2 : 1);
      out.arrival = start + latency_ + (fate.delay ? delay_ : 0) + (fate.reorder ? cycles : 0);
      break;
    }
    // In order, whatever is late.
    last_ = out.arrival = std::max(out.arrival, last_);
    return out;
  }

  /// The acknowledgement that would come at `at`, not before any other: how many places the sender knows to be free
  /// again by it. Call made_good(at) before.
  std::uint32_t acknowledge(Cycle at) {
    const FaultDraw fate = ack_injector_.next(counts_);
    const bool lost = fate.drop || fate.corrupt;
    if (lost || fate.delay || fate.reorder) {
      // One that the next one overtakes says nothing new when it comes.
      silent_.push_back(lost || fate.reorder ? kNever : at + delay_);
      if (any_hit_at_ == kNever) any_hit_at_ = at + patience();
      return 0;
    }
    return hear(silent_.size()) + 1;
  }
  /// What late acknowledgements and asking again have brought by `now`.
  struct Recovered {
    std::uint32_t places = 0;
    Cycle busy = 0;  ///< for which the link was asked over
  };
  Recovered made_good(Cycle now) {
    Recovered out;
    while (!silent_.empty()) {
      const auto first = std::min_element(silent_.begin(), silent_.end());
      if (std::min(*first, any_hit_at_) > now) break;
      if (*first <= any_hit_at_)
        out.places += hear(static_cast<std::size_t>(first - silent_.begin()) + 1);
      else
        out.busy += ask();
    }
    return out;
  }
  /// When made_good() will bring something, or may.
  Cycle next() const {
    if (silent_.empty()) return kNever;
    return std::min(*std::min_element(silent_.begin(), silent_.end()), any_hit_at_);
  }
  const LinkFaultCounts& counts() const { return counts_; }

 private:
  /// Until an answer would be there.
  Cycle patience() const { return 2 * latency_ + cycles_; }
  std::uint32_t hear(std::size_t count) {
    silent_.erase(silent_.begin(), silent_.begin() + static_cast<std::ptrdiff_t>(count));
    if (silent_.empty()) any_hit_at_ = kNever;
    return static_cast<std::uint32_t>(count);
  }
  /// The last frame once more. What it was asked for comes with the answer, if both get through.
  Cycle ask() {
    ++counts_.resent;
    const FaultDraw frame = ack_injector_.next(counts_);
    counts_.discarded += !frame.drop;
    const bool through = !frame.drop && !frame.corrupt;
    const FaultDraw answer = through ? ack_injector_.next(counts_) : FaultDraw{};
    if (through && !answer.drop && !answer.corrupt)
      silent_.back() =
          std::min(silent_.back(), any_hit_at_ + patience() + (frame.delay ? delay_ : 0) + (answer.delay ? delay_ : 0));
    any_hit_at_ += cycles_ + patience();
    return cycles_;
  }

  FaultInjector injector_, ack_injector_;
  Cycle delay_, latency_;
  Cycle cycles_ = 1;  // of the last packet
  Cycle last_ = 0;
  bool overtaken_ = false;     // the one before comes after the next
  std::deque<Cycle> silent_;   // acknowledgements that did not come when they should: when they will, or never
  Cycle any_hit_at_ = kNever;  // while there are any
  LinkFaultCounts counts_;
};

}  // namespace carousel::ringbus::cycle
