#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "accel/box/slab.h"
#include "core/types/aabb.h"
#include "core/types/ray.h"

namespace carousel::accel {

/// The least float that is not below `x`, which is not negative.
[[gnu::always_inline]] inline float round_up(double x) {
  const float nearest = static_cast<float>(x);
  return nearest < x ? std::bit_cast<float>(std::bit_cast<std::uint32_t>(nearest) + 1) : nearest;
}

/// A ray as the slab test in double wants it (accuracy.box: double). No operation on widened floats leaves the
/// range of double, so what SlabRay must do about denormals does not arise. Entries are rounded up to float:
/// entry <= tmax says the same before and after, and rounding up is monotone, so every enclosing box is still
/// entered no later.
struct DoubleSlabRay {
  double origin[3];
  double inverse_near[3];
  double inverse_far[3];      ///< widened
  std::uint32_t near_row[3];  ///< byte offsets of rows of Node::plane, as in SlabRay
  std::uint32_t far_row[3];
  float tmin;

  [[gnu::always_inline]] explicit DoubleSlabRay(const Ray& ray, float widening = kFarWidening) : tmin(ray.tmin) {
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis] = ray.origin[axis];
      inverse_near[axis] = 1.0 / ray.direction[axis];
      inverse_far[axis] = inverse_near[axis] * widening;
      const bool negative = std::signbit(ray.direction[axis]);
      const auto row = static_cast<std::uint32_t>(axis);
      near_row[axis] = (negative ? row + 3 : row) * SlabRay::kRowBytes;
      far_row[axis] = (negative ? row : row + 3) * SlabRay::kRowBytes;
    }
  }
};

/// One box, one ray, operation for operation what slab_node() does in a lane.
/// Returns whether it is hit before tmax; `entry` is the entry distance, not below tmin.
[[gnu::always_inline]] inline bool slab(const DoubleSlabRay& ray, const Aabb& box, float tmax, float& entry) {
  double near = ray.tmin, far = tmax;
  for (int axis = 0; axis < 3; ++axis) {
    const bool backwards = ray.near_row[axis] >= 3 * SlabRay::kRowBytes;
    const double near_plane = backwards ? box.hi[axis] : box.lo[axis];
    const double far_plane = backwards ? box.lo[axis] : box.hi[axis];
    const double n = (near_plane - ray.origin[axis]) * ray.inverse_near[axis];
    const double f = (far_plane - ray.origin[axis]) * ray.inverse_far[axis];
    near = n > near ? n : near;
    far = f < far ? f : far;
  }
  entry = round_up(near);
  return near <= far;
}

}  // namespace carousel::accel
