#pragma once

#include <cstdint>

namespace carousel::ringbus::cycle {

/// Bytes of rays and paths that ray control and shading have read from memory and written to it.
struct RayDataUse {
  struct Moved {
    std::uint64_t read = 0, written = 0;
    friend bool operator==(const Moved&, const Moved&) = default;
  };
  Moved records;  ///< master copies of rays (memory.ray_records)
  Moved states;   ///< path states (memory.path_state)
  Moved film;     ///< pixels (memory.film)
  friend bool operator==(const RayDataUse&, const RayDataUse&) = default;
};

/// Lines that were written in caches with `memory.l2_write: back` and were still there at the end of the run. They are
/// written to memory then.
struct CacheDrain {
  std::uint64_t lines = 0, bytes = 0;
  std::uint64_t cycles = 0;  ///< from the end of the run to the last of them
  friend bool operator==(const CacheDrain&, const CacheDrain&) = default;
};

}  // namespace carousel::ringbus::cycle
