#pragma once

#include <cstdint>

#include "core/types/ids.h"
#include "core/types/workload.h"

namespace carousel::shading {

/// Receives every completed ray, e.g. to list them. Calls for one worker come one at a time, for different
/// workers at the same time; the order depends on the engine.
class RayRecorder {
 public:
  virtual ~RayRecorder() = default;
  virtual void record(WorkerId worker, std::uint32_t pixel, std::uint32_t sample, const RayResult& result) = 0;
};

}  // namespace carousel::shading
