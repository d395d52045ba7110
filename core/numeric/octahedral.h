#pragma once

#include <cmath>

#include "core/types/vec.h"

namespace carousel {

/// A unit vector as a point of the square [0, 1] x [0, 1]: Cigolle et al., "A survey of efficient representations for
/// independent unit vectors", JCGT 2014, section 3 (the octahedron unfolded). Arithmetic only, so the same everywhere.
inline Vec2 octahedral(const DVec3& n) {
  const double scale = 1.0 / (std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z));
  double x = n.x * scale, y = n.y * scale;
  if (n.z < 0) {
    const double folded = (1 - std::fabs(y)) * (x < 0 ? -1 : 1);
    y = (1 - std::fabs(x)) * (y < 0 ? -1 : 1);
    x = folded;
  }
  return {static_cast<float>(0.5 * x + 0.5), static_cast<float>(0.5 * y + 0.5)};
}

/// The vector back, of unit length.
inline DVec3 from_octahedral(float u, float v) {
  double x = 2.0 * u - 1, y = 2.0 * v - 1;
  const double z = 1 - std::fabs(x) - std::fabs(y);
  if (z < 0) {
    const double folded = (1 - std::fabs(y)) * (x < 0 ? -1 : 1);
    y = (1 - std::fabs(x)) * (y < 0 ? -1 : 1);
    x = folded;
  }
  const double scale = 1 / std::sqrt(x * x + y * y + z * z);
  return {x * scale, y * scale, z * scale};
}

}  // namespace carousel
