#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "ringbus/cycle/clock.h"
#include "ringbus/faults/fault_dice.h"

namespace carousel::ringbus::cycle {

/// When a packet gets over a link that fails, in virtual time. With go-back-N everything behind a lost frame is sent
/// again after it, so what is behind counts from the moment the lost one has got through: the link is as good as busy
/// until then.
class LinkFaultTimer {
 public:
  LinkFaultTimer(const FaultsConfig& config, std::uint64_t link)
      : dice_(config, 2 * link), delay_(static_cast<Cycle>(config.links.delay_cycles)) {}

  struct Delivery {
    Cycle arrival = 0;     ///< of the head
    Cycle link_free = 0;   ///< when the next one may start
    Cycle busy = 0;        ///< for which the link moved something
  };
  /// A packet of `cycles` that starts `now` on a link of a latency.
  Delivery send(Cycle now, Cycle cycles, Cycle latency) {
    const Cycle patience = 2 * latency + cycles;   // until the acknowledgement would be there
    Delivery out;
    Cycle start = now;
    for (bool first = true;; first = false) {
      counts_.resent += !first;
      const FrameFate fate = dice_.next(counts_);
      out.busy += cycles * (fate.duplicate && !fate.drop ? 2 : 1);
      counts_.discarded += fate.duplicate && !fate.drop;
      // It comes before the one that was overtaken, and is not taken.
      const bool early = std::exchange(overtaken_, false) && first;
      if (fate.drop || fate.corrupt || early) {
        counts_.discarded += !fate.drop;
        start += cycles + patience;
        continue;
      }
      overtaken_ = fate.reorder;
      out.link_free = start + cycles * (fate.duplicate ? 2 : 1);
      out.arrival = start + latency + (fate.delay ? delay_ : 0) + (fate.reorder ? cycles : 0);
      break;
    }
    // In order, whatever is late.
    last_ = out.arrival = std::max(out.arrival, last_);
    return out;
  }
  const LinkFaultCounts& counts() const { return counts_; }

 private:
  FaultDice dice_;
  Cycle delay_;
  Cycle last_ = 0;
  bool overtaken_ = false;   // the one before comes after the next
  LinkFaultCounts counts_;
};

}  // namespace carousel::ringbus::cycle
