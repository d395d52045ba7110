#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

#include "accel/structure/node.h"
#include "core/config/fields/accuracy.h"
#include "core/types/aabb.h"
#include "core/types/ray.h"

namespace carousel::accel {

/// The factor by which the distances of far planes are widened. Exact geometry needs 1 + 2 gamma(3), about 6 units of
/// rounding u = 2^-24 (Ize 2013); the watertight kernel's own rounding moves a hit sideways by up to about 5 u more of
/// the distance travelled along an axis, and near and far each have an error of 3 u. Without this slack a box that is
/// right for the exact ray may disagree with the rounded triangle test, which opens leaks.
inline constexpr float kFarWidening = 1.0f + 0x1p-20f;  // 16 u

/// The widening of a level. In double the slab's own rounding needs almost none of it, but the float triangle kernels
/// move their hits as far as before.
constexpr float far_widening(BoxLevel level) {
  return level == BoxLevel::kPlain ? 1.0f : kFarWidening;
}

/// A ray as the slab test wants it. A box hit by it is hit by every box around it, entered no later: each
/// operation is monotone in the plane. The arrays are written a register at a time (x, y, z, unused).
struct SlabRay {
  static constexpr std::uint32_t kRowBytes = sizeof(Node::plane[0]);

  alignas(16) float origin[4];
  alignas(16) float inverse_near[4];
  alignas(16) float inverse_far[4];  ///< widened
  std::uint32_t near_row[3];         ///< byte offsets of rows of Node::plane: row axis, or axis + 3
  std::uint32_t far_row[3];
  float tmin;

  /// `widening` is that of the level: far_widening().
  [[gnu::always_inline]] explicit SlabRay(const Ray& ray, float widening = kFarWidening) : tmin(ray.tmin) {
    using Float4 = float __attribute__((vector_size(16)));
    using Int4 = std::int32_t __attribute__((vector_size(16)));
    const Float4 o{ray.origin.x, ray.origin.y, ray.origin.z, 0.0f};
    const Float4 d{ray.direction.x, ray.direction.y, ray.direction.z, 1.0f};
    const Float4 inverse = 1.0f / d;
    const Float4 far = inverse * widening;
    // The reciprocal of a denormal overflows: a finite stand-in for the near planes, too early rather than too
    // late, and infinity for the far ones. A zero keeps its infinity.
    constexpr float kMax = std::numeric_limits<float>::max();
    const Int4 overflow = (d != 0.0f) & ((inverse > kMax) | (inverse < -kMax));
    const Float4 near = overflow ? (d < 0.0f ? Float4{} - kMax : Float4{} + kMax) : inverse;
    std::memcpy(origin, &o, sizeof(o));
    std::memcpy(inverse_near, &near, sizeof(near));
    std::memcpy(inverse_far, &far, sizeof(far));
    // By arithmetic: compilers make a branch of a conditional, and the signs of bounce rays are hard to guess.
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const std::uint32_t negative = std::bit_cast<std::uint32_t>(ray.direction[static_cast<int>(axis)]) >> 31;
      near_row[axis] = (axis + 3 * negative) * kRowBytes;
      far_row[axis] = (axis + 3 - 3 * negative) * kRowBytes;
    }
  }
};

/// One box, one ray, operation for operation what slab_node() does in a lane.
/// Returns whether it is hit before tmax; `entry` is the entry distance, not below tmin.
[[gnu::always_inline]] inline bool slab(const SlabRay& ray, const Aabb& box, float tmax, float& entry) {
  float near = ray.tmin, far = tmax;
  for (int axis = 0; axis < 3; ++axis) {
    const float near_plane = ray.near_row[axis] < 3 * SlabRay::kRowBytes ? box.lo[axis] : box.hi[axis];
    const float far_plane = ray.far_row[axis] < 3 * SlabRay::kRowBytes ? box.lo[axis] : box.hi[axis];
    const float n = (near_plane - ray.origin[axis]) * ray.inverse_near[axis];
    const float f = (far_plane - ray.origin[axis]) * ray.inverse_far[axis];
    near = n > near ? n : near;
    far = f < far ? f : far;
  }
  entry = near;
  return near <= far;
}

}  // namespace carousel::accel
