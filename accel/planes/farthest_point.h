#pragma once

#include "accel/structure/accel.h"
#include "core/config/fields/cull_planes.h"
#include "core/types/vec.h"

namespace carousel::accel {

/// Distance along `direction` of the farthest vertex below `root`, of one mesh, in its space; with `fit: boxes` no
/// farther than the boxes of the root's children. In double, with an error of at most 2^-50 of the sum of the terms'
/// magnitudes.
double farthest_along(const Accel& accel, NodeRef root, const DVec3& direction, CullPlanesConfig::Fit fit);

/// A box that holds all vertices below `root`: of its children's boxes, or of a leaf's triangles.
Aabb model_box(const Accel& accel, NodeRef root);

/// Distance along `direction` of the farthest corner of a box.
inline double farthest_corner(const Aabb& box, const DVec3& direction) {
  double most = 0;
  for (int axis = 0; axis < 3; ++axis) most += direction[axis] * (direction[axis] < 0 ? box.lo[axis] : box.hi[axis]);
  return most;
}

}  // namespace carousel::accel
