#pragma once

#include <algorithm>
#include <cmath>

#include "core/types/vec.h"
#include "shading/math/disk.h"

namespace carousel::shading {

inline constexpr float kInvPi = 0.318309886f;
inline constexpr float kPi = 3.14159265f;

/// A local direction with density cos / pi.
inline Vec3 sample_cosine(const Vec2& u) {
  const Vec2 d = square_to_disk(u);
  return {d.x, d.y, std::sqrt(std::max(0.0f, 1.0f - d.x * d.x - d.y * d.y))};
}
inline float cosine_pdf(float cos_theta) {
  return cos_theta * kInvPi;
}

}  // namespace carousel::shading
