#pragma once

#include <cmath>

#include "core/types/vec.h"
#include "shading/math/trigonometry.h"

namespace carousel::shading {

/// Maps the unit square to the unit disk with equal areas and little distortion, so that strata stay compact:
/// P. Shirley, K. Chiu, "A low distortion map between disk and square", Journal of Graphics Tools 2(3), 1997.
inline Vec2 square_to_disk(const Vec2& u) {
  const float a = 2.0f * u.x - 1.0f, b = 2.0f * u.y - 1.0f;
  if (a == 0.0f && b == 0.0f) return {0, 0};
  if (std::abs(a) > std::abs(b)) {
    const SinCos angle = sin_cos_turns(0.125f * (b / a));
    return {a * angle.cos, a * angle.sin};
  }
  const SinCos angle = sin_cos_turns(0.125f * (a / b));
  return {b * angle.sin, b * angle.cos};
}

}  // namespace carousel::shading
