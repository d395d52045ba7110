#pragma once

#include <algorithm>
#include <cstdint>

#include "ringbus/time/clock.h"

namespace carousel::ringbus {

/// What the stops of a ring without queues have done, by the clock of the ring.
struct StopRingUse {
  std::uint64_t extra_rounds = 0;  ///< flits that found the port busy, or no place, each time once
  Cycle longest_ride = 0;          ///< of a flit, from getting on until it gets off
  Cycle longest_wait = 0;          ///< of a packet that was the first at its stop
  std::uint64_t reservations = 0;  ///< slots or grants reserved after fair_after_cycles
  std::uint64_t starts = 0;        ///< packets that have left their stops, answers included

  /// Of several rings together.
  StopRingUse& operator+=(const StopRingUse& o) {
    extra_rounds += o.extra_rounds;
    longest_ride = std::max(longest_ride, o.longest_ride);
    longest_wait = std::max(longest_wait, o.longest_wait);
    reservations += o.reservations;
    starts += o.starts;
    return *this;
  }
  friend bool operator==(const StopRingUse&, const StopRingUse&) = default;
};

}  // namespace carousel::ringbus
