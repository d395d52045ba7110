#pragma once

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

/// Lines that a machine's caches hold before it starts, so that a pilot has the frame's share of first misses: a part
/// of those that they held at the end of the frame's run, drawn line by line.
struct WarmCaches {
  const std::vector<std::vector<std::uint64_t>>* lines = nullptr;  ///< by cache; null: the caches are cold
  double part = 0;
};

}  // namespace carousel::ringbus::cycle
