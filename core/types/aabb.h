#pragma once

#include <limits>

#include "core/types/vec.h"

namespace carousel {

/// Axis-aligned box, closed on all sides. The default is empty: lo = +inf, hi = -inf.
struct Aabb {
  Vec3 lo{std::numeric_limits<float>::infinity()};
  Vec3 hi{-std::numeric_limits<float>::infinity()};

  void extend(const Vec3& p) {
    for (int a = 0; a < 3; ++a) {
      lo[a] = p[a] < lo[a] ? p[a] : lo[a];
      hi[a] = p[a] > hi[a] ? p[a] : hi[a];
    }
  }
  void extend(const Aabb& b) {
    for (int a = 0; a < 3; ++a) {
      lo[a] = b.lo[a] < lo[a] ? b.lo[a] : lo[a];
      hi[a] = b.hi[a] > hi[a] ? b.hi[a] : hi[a];
    }
  }
  bool empty() const { return lo.x > hi.x || lo.y > hi.y || lo.z > hi.z; }
  Vec3 centre() const { return 0.5f * lo + 0.5f * hi; }
  Vec3 extent() const { return hi - lo; }
  /// Half the surface area; 0 for an empty box.
  float half_area() const {
    if (empty()) return 0.0f;
    const Vec3 e = extent();
    return e.x * e.y + e.y * e.z + e.z * e.x;
  }
};

}  // namespace carousel
