#pragma once

#include "core/numeric/digest.h"
#include "core/types/nearest_counts.h"

namespace carousel::ringbus {

/// What the rays of a run that look for several hits (`rays.query.nearest`) have found, and its cost.
struct NearestResult {
  NearestUse use;
  HitsDigest digest;  ///< over all hits of completed rays, by the bits of the ray and the rank of the hit
};

}  // namespace carousel::ringbus
