#pragma once

#include "core/types/vec.h"
#include "scene/model/scene.h"

namespace carousel::shading {

/// What a ray that hits nothing sees.
inline Vec3 sky_radiance(const scene::Sky& sky, const Vec3& /*direction*/) {
  return sky.radiance;
}

}  // namespace carousel::shading
