#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// The faults of a link's frames, acknowledgements included, and the work of recovering from them.
struct LinkFaultCounts {
  std::uint64_t dropped = 0, duplicated = 0, corrupted = 0, reordered = 0, delayed = 0, resent = 0, discarded = 0;

  static constexpr auto counters() {
    using C = LinkFaultCounts;
    return std::array{
        Counter{"dropped", &C::dropped, "frames", "frames lost on the way"},
        Counter{"duplicated", &C::duplicated, "frames", "frames delivered twice"},
        Counter{"corrupted", &C::corrupted, "frames", "frames in which a bit was flipped"},
        Counter{"reordered", &C::reordered, "frames", "frames delivered after the next one"},
        Counter{"delayed", &C::delayed, "frames", "frames delivered late"},
        Counter{"resent", &C::resent, "frames", "frames sent again"},
        Counter{"discarded", &C::discarded, "frames", "frames the receiver rejected: damaged, early, or had already"},
    };
  }
  friend bool operator==(const LinkFaultCounts&, const LinkFaultCounts&) = default;
};

}  // namespace carousel
