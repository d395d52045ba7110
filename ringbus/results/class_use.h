#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <vector>

#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The use of a class of equal parts of the machine up to some cycle.
struct ClassUse {
  std::string_view name;  ///< as in `bottleneck` and `bound` of the report; a literal
  double parts = 0;       ///< parts side by side
  Cycle busy = 0;         ///< cycles in which a part worked, summed over the parts
  Cycle most = 0;         ///< those of the part that worked most, or of equal parts at one place in the mean

  /// Counts so many more parts at one place, or what parts did that are counted already (0).
  void count(double more, Cycle cycles) {
    parts += more;
    busy += cycles;
    most = std::max(most, more > 1 ? static_cast<Cycle>(static_cast<double>(cycles) / more) : cycles);
  }
  friend bool operator==(const ClassUse&, const ClassUse&) = default;
};

/// How far a simulated machine had come at a time.
struct ProgressSample {
  Cycle at = 0;
  std::uint64_t completed = 0;               ///< rays
  std::vector<Cycle> busy;                   ///< busy cycles of each class, in the order of CycleResult::uses
  std::uint64_t reads = 0, first_reads = 0;  ///< lines read from memory, and those read for the first time
  friend bool operator==(const ProgressSample&, const ProgressSample&) = default;
};

/// Lines of a machine's caches, a list a cache, the oldest of a set first.
using CacheLines = std::vector<std::vector<std::uint64_t>>;

/// Shapes that the resources' shape buffers hold, a list a resource, those that were used last first.
struct BufferedShapes {
  std::uint64_t address = 0;
  std::uint32_t bytes = 0;
  friend bool operator==(const BufferedShapes&, const BufferedShapes&) = default;
};
using BufferShapes = std::vector<std::vector<BufferedShapes>>;

/// What a machine's caches and shape buffers hold before it starts, so that a pilot has the frame's share of first
/// misses: a part of what they held at the end of the frame's run, drawn line by line. The rest are the lines that
/// caches held at its start, if any; so a line that they held at both times is there. Shape buffers and resources' own
/// caches were empty then. A cache with more room than that of the run holds lines that this replaced, too, which stand
/// first.
struct WarmCaches {
  const CacheLines* lines = nullptr;  ///< at the end; null: the caches are cold
  double part = 0;
  const CacheLines* start = nullptr;      ///< null: they were cold
  const BufferShapes* buffers = nullptr;  ///< at the end; null: they are empty
  const CacheLines* own = nullptr;        ///< of the resources' own caches at the end; null: they are cold

  /// Where the draw of a line or address falls, from 0 to 1. It is there at the start if that is below `part`.
  static double drawn(std::uint64_t line) {
    const std::uint64_t mixed = (line + 1) * 0x9e3779b97f4a7c15ull,
                        at = (mixed ^ (mixed >> 31)) * 0xbf58476d1ce4e5b9ull;
    return static_cast<double>(at >> 11) * 0x1p-53;
  }
};

}  // namespace carousel::ringbus::cycle
