#pragma once

#include <array>
#include <functional>
#include <vector>

#include "accel/structure/cull_plane.h"
#include "core/types/aabb.h"
#include "core/types/vec.h"

namespace carousel::accel {

/// A child: its box, and how far along a plane's normal what stands in it reaches, from the box's plane_centre().
struct BoxedShape {
  Aabb box;
  std::function<float(const CullPlane&)> distance;  ///< rounded up
};

/// Sets a plane's normal to a direction of any length: the sum of the entries' magnitudes is just below 1. False if the
/// direction has no length.
bool set_normal(const DVec3& direction, CullPlane& plane);

/// Distance of the farthest of the points along `n`, from a box's plane_centre(), rounded up, so that a plane at this
/// distance cuts off no point. Infinite if there is no such float.
float distance_along(const CullPlane& plane, const Aabb& box, const std::vector<Vec3>& points);

/// Distance of the farthest point of a sphere along `n`, with the same origin and rounding as that of points above.
float distance_along(const CullPlane& plane, const Aabb& box, const Vec3& centre, float radius);

/// The part of the box's volume that the plane cuts off, between 0 and 1. The estimate decides if a plane is worth it.
double empty_part(const CullPlane& plane, const Aabb& box);

/// The best plane in each octant of directions: planes of different octants cut off different corners.
class OctantBest {
 public:
  /// A normal without an entry along an axis belongs to the octants on both sides.
  void offer(const CullPlane& plane, double worth);
  /// Up to `most` planes, the best first, all worth more than `least`.
  std::vector<CullPlane> best(int most, double least) const;

 private:
  struct Candidate {
    CullPlane plane{};
    double worth = 0;
  };
  std::array<Candidate, 8> octants_{};
};

/// Planes for one child, the best of those offered.
class PlaneChoice {
 public:
  explicit PlaneChoice(const BoxedShape& child) : child_(child) {}

  /// Any length of `direction`, which need not be of use.
  void offer(const DVec3& direction);
  void offer_both(const DVec3& direction) {
    offer(direction);
    offer(-direction);
  }
  /// Planes that cut off the corners of the box evenly: the candidates if nothing else is known.
  void offer_octants();
  /// Up to `most` planes, the largest empty part first; fewer when others cut nothing off.
  std::vector<CullPlane> best(int most) const;

 private:
  const BoxedShape& child_;
  OctantBest best_;
};

/// Planes for siblings that share their normals: of the candidates' directions those that cut most off all boxes
/// together, a box counting by its area, as rays meet it. As many for each sibling, in the same order; none for one
/// that has nothing to cut off.
std::vector<std::vector<CullPlane>> shared_planes(const std::vector<BoxedShape>& siblings,
                                                  const std::vector<CullPlane>& candidates, int most);

}  // namespace carousel::accel
