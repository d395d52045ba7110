#pragma once

#include "core/vec.h"
#include "scene/scene.h"

namespace carousel::shading {

/// What a ray that hits nothing sees.
inline Vec3 sky_radiance(const scene::Sky& sky, const Vec3& /*direction*/) {
  return sky.radiance;
}

}  // namespace carousel::shading
