#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// Use of a resource's collections. A sum over resources adds up their peaks, which need not have been at one time.
struct CollectionCounts {
  std::uint64_t created = 0, peak = 0, memberships_peak = 0, spilled = 0;

  static constexpr auto counters() {
    using C = CollectionCounts;
    return std::array{
        Counter{"collections_created", &C::created, "collections", "collections created in all"},
        Counter{"collections_peak", &C::peak, "collections", "most collections at one time"},
        Counter{"memberships_peak", &C::memberships_peak, "ray IDs", "most ray IDs in collections at one time"},
        Counter{"spilled", &C::spilled, "ray IDs", "ray IDs stored in blocks beyond the capacity"},
    };
  }
  friend bool operator==(const CollectionCounts&, const CollectionCounts&) = default;
};

/// Bytes of collection entries that were moved to memory and back.
struct SpillBytes {
  std::uint64_t written = 0, read = 0;

  static constexpr auto counters() {
    using C = SpillBytes;
    return std::array{
        Counter{"spill_bytes_written", &C::written, "bytes", "bytes of spilled entries sent to memory"},
        Counter{"spill_bytes_read", &C::read, "bytes", "bytes of spilled entries read back"},
    };
  }
  friend bool operator==(const SpillBytes&, const SpillBytes&) = default;
};

}  // namespace carousel
