#pragma once

#include <cmath>

#include "core/numeric/trigonometry.h"
#include "core/types/vec.h"

namespace carousel::scene {

/// The place to which a turn about the y axis by `angle` (radians) brings `at`. An angle of 0 changes no bit.
inline Vec3 turned(const Vec3& at, float angle) {
  if (angle == 0) return at;
  const float c = cos_float(angle), s = sin_float(angle);
  return {c * at.x + s * at.z, at.y, c * at.z - s * at.x};
}

}  // namespace carousel::scene
