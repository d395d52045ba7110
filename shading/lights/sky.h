#pragma once

#include "core/types/vec.h"
#include "scene/model/scene.h"

namespace carousel::shading {

/// Radiance along a ray that hits nothing.
inline Vec3 sky_radiance(const scene::Sky& sky, const Vec3& /*direction*/) {
  return sky.radiance;
}

}  // namespace carousel::shading
