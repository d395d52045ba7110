#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "ringbus/cycle/time/clock.h"

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
  std::uint64_t completed = 0;  ///< rays
  std::vector<Cycle> busy;      ///< of each class, in the order of CycleResult::uses
  friend bool operator==(const ProgressSample&, const ProgressSample&) = default;
};

}  // namespace carousel::ringbus::cycle
