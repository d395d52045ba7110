#pragma once

#include <cstddef>

#include "ringbus/results/trace.h"

namespace carousel::ringbus::cycle {

/// Parts of a simulated run that are recorded beside its counts.
struct Observation {
  TraceWindow steps{};      ///< the steps of these cycles
  std::size_t samples = 0;  ///< most samples of the time series; 0: none
};

}  // namespace carousel::ringbus::cycle
