#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// Use of a resource's shape buffer.
struct ShapeBufferCounts {
  std::uint64_t hits = 0, merged = 0, misses = 0, evictions = 0, room_waits = 0, pushed = 0, pushed_in_vain = 0;

  static constexpr auto counters() {
    using C = ShapeBufferCounts;
    return std::array{
        Counter{"hits", &C::hits, "strips", "strips and transforms that were there when they were needed"},
        Counter{"merged", &C::merged, "strips", "strips and transforms that were already on their way"},
        Counter{"misses", &C::misses, "strips", "strips and transforms that were fetched"},
        Counter{"evictions", &C::evictions, "strips", "strips and transforms that gave up their places"},
        Counter{"pushed", &C::pushed, "strips",
                "strips and transforms that came because another resource asked for them"},
        Counter{"pushed_in_vain", &C::pushed_in_vain, "strips",
                "those that were there already or on their way, or for which no places were free"},
        Counter{"room_waits", &C::room_waits, "waits", "waits of a packet or ray for places that others needed"},
    };
  }
  friend bool operator==(const ShapeBufferCounts&, const ShapeBufferCounts&) = default;
};

/// Reads of the nodes and leaves at one depth of the structure.
struct StripReads {
  std::uint64_t needed = 0, misses = 0;

  static constexpr auto counters() {
    using C = StripReads;
    return std::array{
        Counter{"needed", &C::needed, "strips",
                "times that a resource needed them from its shape buffer, lines with testers.simt; not as part of "
                "treelets or blocks of memory"},
        Counter{"misses", &C::misses, "strips",
                "those that were fetched, since they were neither there nor on their "
                "way"},
    };
  }
  friend bool operator==(const StripReads&, const StripReads&) = default;
};

}  // namespace carousel
