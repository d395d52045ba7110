#pragma once

#include <array>
#include <vector>

#include "accel/cull_plane.h"
#include "core/aabb.h"
#include "core/vec.h"

namespace carousel::accel {

/// How far `n` points along the farthest of the points, from a box's plane_centre(): rounded up, so that with a plane at
/// this distance no point is cut off. Infinite when there is no such float.
float distance_along(const CullPlane& plane, const Aabb& box, const std::vector<Vec3>& points);

/// The part of the box's volume that the plane cuts off, between 0 and 1. An estimate: it decides what is worth having.
double empty_part(const CullPlane& plane, const Aabb& box);

/// Of the planes offered for one box, the best in each octant of directions: planes of different octants cut off
/// different corners.
class PlaneChoice {
 public:
  PlaneChoice(const Aabb& box, const std::vector<Vec3>& points) : box_(box), points_(points) {}

  /// Any length of `direction`, which need not be of use.
  void offer(const DVec3& direction);
  void offer_both(const DVec3& direction) {
    offer(direction);
    offer(-direction);
  }
  /// The corners of the box cut off evenly: what is there when nothing else is known.
  void offer_octants();
  /// Up to `most` planes, the largest empty part first; fewer when others cut nothing off.
  std::vector<CullPlane> best(int most) const;

 private:
  struct Candidate {
    CullPlane plane{};
    double empty = 0;
  };
  const Aabb& box_;
  const std::vector<Vec3>& points_;
  std::array<Candidate, 8> octants_{};
};

}  // namespace carousel::accel
