#pragma once

#include <cmath>

#include "accel/box/slab.h"

namespace carousel::accel {

/// A ray whose slab tests have a slack: they take each box for larger by `slack` along each axis, to either side. Boxes
/// are entered earlier and left later, each by a ray that starts so much farther along or farther back.
struct WideSlabRay {
  SlabRay slab;
  float near_origin[3], far_origin[3];

  WideSlabRay(const Ray& ray, const Vec3& slack) : slab(ray) {
    for (int axis = 0; axis < 3; ++axis) {
      const float along = std::copysign(slack[axis], ray.direction[axis]);
      near_origin[axis] = ray.origin[axis] + along;
      far_origin[axis] = ray.origin[axis] - along;
    }
  }
};

}  // namespace carousel::accel
