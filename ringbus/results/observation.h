#pragma once

#include <cstddef>

#include "ringbus/results/memory_request.h"
#include "ringbus/results/ray_log.h"
#include "ringbus/results/ray_times.h"
#include "ringbus/results/slice_log.h"
#include "ringbus/results/trace.h"

namespace carousel::ringbus::cycle {

/// Parts of a simulated run that are recorded beside its counts.
struct Observation {
  TraceWindow steps{};          ///< the steps of these cycles
  std::size_t samples = 0;      ///< most samples of the time series; 0: none
  TimelineOptions timeline{};   ///< slices of time
  FollowedRay* ray = nullptr;   ///< the life of this ray, in place of the timeline
  MemoryLog* memory = nullptr;  ///< requests to the memory are appended
  bool ray_times = false;       ///< where all rays' cycles go
  std::span<PixelCost> heat{};  ///< with ray_times: the cost of each pixel is added, if there are any
};

}  // namespace carousel::ringbus::cycle
