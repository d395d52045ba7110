#pragma once

#include <algorithm>
#include <cstdint>

#include "core/config/fields/topology.h"
#include "core/numeric/divisor.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The near end of a wire beside the links, as wide as a link. As on a link, a message of n bytes occupies it for
/// ceil(n / width) cycles; its head arrives after the latency, its tail correspondingly later, and the receiver waits
/// for the tail. Messages go out in the order in which they are handed over.
class SideWire {
 public:
  SideWire(const LinkConfig& link, Cycle latency)
      : width_(static_cast<std::uint64_t>(link.bytes_per_cycle)), latency_(latency) {}

  /// Takes a message of `bytes`, at least one, that is there in cycle `now`. Returns the cycle in which it has arrived.
  Cycle send(std::uint64_t bytes, Cycle now) {
    free_at_ = std::max(free_at_, now) + width_.ceiling(bytes);
    return free_at_ - 1 + latency_;
  }

 private:
  Divisor width_;
  Cycle latency_;
  Cycle free_at_ = 0;
};

}  // namespace carousel::ringbus::cycle
