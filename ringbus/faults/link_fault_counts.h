#pragma once

#include <cstdint>

namespace carousel::ringbus {

/// What befell a link's frames, acknowledgements included, and what it took to make it good.
struct LinkFaultCounts {
  std::uint64_t dropped = 0, duplicated = 0, corrupted = 0, reordered = 0, delayed = 0;
  std::uint64_t resent = 0;     ///< frames sent again
  std::uint64_t discarded = 0;  ///< frames the receiver had no use for: damaged, early, or had already

  LinkFaultCounts& operator+=(const LinkFaultCounts& o) {
    dropped += o.dropped;
    duplicated += o.duplicated;
    corrupted += o.corrupted;
    reordered += o.reordered;
    delayed += o.delayed;
    resent += o.resent;
    discarded += o.discarded;
    return *this;
  }
  friend bool operator==(const LinkFaultCounts&, const LinkFaultCounts&) = default;
};

}  // namespace carousel::ringbus
