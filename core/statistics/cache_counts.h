#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// Use of a cache of shape data.
struct CacheCounts {
  std::uint64_t requests = 0, lines = 0, hits = 0, merged = 0, misses = 0, written = 0, port_busy = 0;

  static constexpr auto counters() {
    using C = CacheCounts;
    return std::array{
        Counter{"requests", &C::requests, "strips", "strips requested"},
        Counter{"lines", &C::lines, "lines", "lines looked up"},
        Counter{"hits", &C::hits, "lines", "lines found"},
        Counter{"merged", &C::merged, "lines", "lines already on their way from memory"},
        Counter{"misses", &C::misses, "lines", "lines fetched from memory"},
        Counter{"written", &C::written, "lines", "lines written through to memory: spilled collection entries"},
        Counter{"port_busy_cycles", &C::port_busy, "cycles", "cycles in which the port looked up lines"},
    };
  }
  friend bool operator==(const CacheCounts&, const CacheCounts&) = default;
};

}  // namespace carousel
