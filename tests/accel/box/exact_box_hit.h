#pragma once

#include <cmath>

#include "accel/certificate/exact_box.h"
#include "core/types/aabb.h"
#include "core/types/ray.h"

namespace carousel::accel {

/// Decides exactly if a ray with tmin = 0 meets a closed box before `tmax`: by doubles if they leave no doubt, by big
/// integers otherwise.
inline bool exactly_hits(const Ray& ray, const Aabb& box, float tmax) {
  double near = 0, far = tmax;
  for (int axis = 0; axis < 3; ++axis) {
    const double d = ray.direction[axis], o = ray.origin[axis];
    if (d == 0) {
      if (o < box.lo[axis] || o > box.hi[axis]) return false;
      continue;
    }
    const double a = (box.lo[axis] - o) / d, b = (box.hi[axis] - o) / d;
    near = std::fmax(near, std::fmin(a, b));
    far = std::fmin(far, std::fmax(a, b));
  }
  if (std::fabs(near - far) > 0x1p-40 * (near + std::fabs(far))) return near < far;
  return ExactBox(ray, box, tmax).hit();
}

}  // namespace carousel::accel
