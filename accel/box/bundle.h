#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/types/ray.h"

namespace carousel::accel {

/// Similar rays, seen as one (US 11308683, fig. 2): bounds of where they start and where they go, one cache line
/// beside the ray's own. World space, or with kInModelSpace that of the instance it stands in; every ray has tmin = 0
/// and is valid(). Among directions, -0 counts as less than +0: the slab test goes by the sign bit, and so the bounds
/// have the same sign exactly when all rays have it.
struct alignas(64) BundleRecord {
  float origin_min[3], origin_max[3];
  float direction_min[3], direction_max[3];
  float tmax = -kInfinity;    ///< the largest of its rays'; may be out of date, and is then too large
  float nearest = kInfinity;  ///< the smallest distance at which one of its rays has hit something
  std::int16_t pending = 0;   ///< tests the bundle still waits for; written by the owner only
  std::uint8_t count = 0;     ///< rays
  std::uint8_t flags = 0;     ///< kInModelSpace
  std::uint32_t rays = 0;     ///< where the slots of its rays stand in the owner's store

  static constexpr std::uint8_t kInModelSpace = 1;

  BundleRecord() {
    std::fill_n(origin_min, 3, kInfinity);
    std::fill_n(origin_max, 3, -kInfinity);
    std::fill_n(direction_min, 3, kInfinity);
    std::fill_n(direction_max, 3, -kInfinity);
  }

  /// Takes a ray's origin and direction into the bounds; `range_end` is its current tmax.
  void widen(const Ray& ray, float range_end) {
    for (int axis = 0; axis < 3; ++axis) {
      origin_min[axis] = std::min(origin_min[axis], ray.origin[axis]);
      origin_max[axis] = std::max(origin_max[axis], ray.origin[axis]);
      const float d = ray.direction[axis];
      if (d < direction_min[axis] || (d == direction_min[axis] && std::signbit(d))) direction_min[axis] = d;
      if (d > direction_max[axis] || (d == direction_max[axis] && !std::signbit(d))) direction_max[axis] = d;
    }
    tmax = std::max(tmax, range_end);
  }
};
static_assert(sizeof(BundleRecord) == 64);

}  // namespace carousel::accel
