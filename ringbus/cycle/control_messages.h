#pragma once

#include <vector>

#include "core/workload.h"
#include "ringbus/ray_id.h"

namespace carousel::ringbus::cycle {

/// New rays whose records have been loaded, for the root collection of a resource.
struct NewRays {
  std::vector<RayId> ids;
};

/// Completed rays on their way to shading, and the slots they leave.
struct CompletedRays {
  HitBatch rays;
  std::vector<std::uint32_t> slots;
};

}  // namespace carousel::ringbus::cycle
