#pragma once

#include <vector>

#include "core/types/ids.h"
#include "core/types/workload.h"
#include "ringbus/rays/ray_id.h"

namespace carousel::ringbus {

/// New rays for a resource's root collection: IDs if they have slots, or the rays themselves if they look for slots on
/// their way round the ring.
struct RayGroup {
  std::vector<RayId> ids;
  RayBatch rays;
  std::vector<ResourceId> addresses;  ///< addressed placement: one a ray; otherwise empty

  /// A bundle counts as one.
  std::size_t rays_in() const { return ids.size() + rays.size(); }
};

}  // namespace carousel::ringbus
