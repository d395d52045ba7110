#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/types/aabb.h"
#include "core/types/ray.h"
#include "core/types/vec.h"

namespace carousel::accel {

/// The facts about the placement of a group besides its transform and its world box, the union of its members' boxes.
///
/// A hit does not depend on the groups around it (docs/how-it-works/design.md, What a hit is, knows instances and
/// triangles only), so a group's nodes may drop no ray that hits something below them: their boxes are tested with a
/// slack. Let R, T place the group or something below it, x be a point at which a ray o + t d meets a triangle's box in
/// the space of its instance, as rounded there, and L the largest distance along an axis of o from the world box and
/// all T. Then |o
/// - T| and |t d| are at most L, and
/// - the rounded ray at t is off by at most gamma(9) |R^-1| 2L in the instance's space, by which the slab test of the
///   triangle's box may be off as well, and |R| times that in the world;
/// - the rounded ray in the group's space is off by gamma(9) |R^-1| 2L, and the slab test there by gamma(3) |R^-1| 2L;
/// - a transpose that stands for an inverse is off by 4 u.
/// In all 50 u s L |R^-1|, with s the largest row of |R| |R^-1| of all that is below; `slack` has 128 u.
struct GroupPlacement {
  std::uint32_t first_member = 0;  ///< in Accel::members: of child k of a node, first_member + its index
  std::uint32_t placement = 0;     ///< in Scene::placements
  Vec3 slack{0};                   ///< added to boxes in the group's space, for each unit of L
  float beyond = 0;                ///< L is so much larger than the largest distance from the world box
  bool from_origin = false;        ///< accuracy.transform: inverse_matrix, whose errors grow with |o| as well

  /// The slack of one ray's tests.
  [[gnu::always_inline]] Vec3 slack_of(const Ray& ray, const Aabb& world) const {
    float distance = 0, size = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float o = ray.origin[axis];
      distance = std::max({distance, std::fabs(world.lo[axis] - o), std::fabs(world.hi[axis] - o)});
      size = std::max(size, std::fabs(o));
    }
    return slack * (distance + beyond + (from_origin ? size : 0.0f)) + 0x1p-120f;
  }
};

/// Bytes of hardware's record of a group's member besides its transform: the world box, and the number of the instance
/// or of the first member's record. The members of a placement have their records one behind the other.
inline constexpr std::uint32_t kMemberBytes = 6 * 4 + 4;
/// Bytes of the record of a group's placement besides that of a member: slack and `beyond`.
inline constexpr std::uint32_t kGroupBytes = 4 * 4;

}  // namespace carousel::accel
