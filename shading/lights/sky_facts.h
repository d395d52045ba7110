#pragma once

#include "core/types/vec.h"
#include "scene/model/sky_map.h"

namespace carousel::shading {

/// What a map of the sky holds, to be told to a user.
struct SkyFacts {
  Vec3 mean{0};    ///< radiance, over the sphere
  float most = 0;  ///< luminance of the brightest texel
  double brightest_percent =
      0;  ///< share of all luminance that comes from the brightest hundredth of the sphere, 0 to 1
};

/// Precondition: the map is not empty.
SkyFacts sky_facts(const scene::SkyMap& map);

}  // namespace carousel::shading
