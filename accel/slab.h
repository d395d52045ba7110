#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "core/aabb.h"
#include "core/ray.h"

namespace carousel::accel {

/// How much farther than computed the far planes are taken to be. Exact geometry needs 1 + 2 gamma(3), about
/// 6 units of rounding u = 2^-24 (Ize 2013); the watertight kernel's own rounding moves a hit sideways by up to
/// about 5 u more of the distance travelled along an axis, and near and far are each off by 3. A box that is
/// right for the exact ray may disagree with the rounded triangle test, which opens leaks.
inline constexpr float kFarWidening = 1.0f + 0x1p-20f;   // 16 u

/// A ray as the slab test wants it. A box hit by it is hit by every box around it, entered no later: each
/// operation is monotone in the plane.
struct SlabRay {
  float origin[3];
  float inverse_near[3];
  float inverse_far[3];      ///< widened by kFarWidening
  std::uint32_t near_row[3]; ///< rows of Node::plane
  std::uint32_t far_row[3];
  float tmin;

  explicit SlabRay(const Ray& ray) : tmin(ray.tmin) {
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const float d = ray.direction[static_cast<int>(axis)];
      origin[axis] = ray.origin[static_cast<int>(axis)];
      const bool negative = std::signbit(d);
      near_row[axis] = negative ? axis + 3 : axis;
      far_row[axis] = negative ? axis : axis + 3;
      inverse_near[axis] = 1.0f / d;
      inverse_far[axis] = inverse_near[axis] * kFarWidening;
      // The reciprocal of a denormal overflows: a finite stand-in for the near planes, too early rather than
      // too late, and infinity for the far ones.
      if (d != 0.0f && std::isinf(inverse_near[axis]))
        inverse_near[axis] = std::copysign(std::numeric_limits<float>::max(), d);
    }
  }
};

/// One box, one ray, operation for operation what slab_node() does in a lane.
/// Returns whether it is hit before tmax; `entry` is the entry distance, not below tmin.
inline bool slab(const SlabRay& ray, const Aabb& box, float tmax, float& entry) {
  float near = ray.tmin, far = tmax;
  for (int axis = 0; axis < 3; ++axis) {
    const float near_plane = ray.near_row[axis] < 3 ? box.lo[axis] : box.hi[axis];
    const float far_plane = ray.far_row[axis] < 3 ? box.lo[axis] : box.hi[axis];
    const float n = (near_plane - ray.origin[axis]) * ray.inverse_near[axis];
    const float f = (far_plane - ray.origin[axis]) * ray.inverse_far[axis];
    near = n > near ? n : near;
    far = f < far ? f : far;
  }
  entry = near;
  return near <= far;
}

}  // namespace carousel::accel
