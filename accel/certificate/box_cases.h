#pragma once

#include <cmath>

#include "accel/certificate/adversarial_numbers.h"
#include "core/types/aabb.h"
#include "core/types/ray.h"

namespace carousel::accel {

/// A ray and a box made to be hard to decide.
struct BoxCase {
  Ray ray;
  Aabb box;
  float tmax = kInfinity;
};

/// Boxes of any place and size whose corners, edges and faces are aimed at, some ulps off. `reach` is that of their
/// exponents, `pace` that of the time it takes to get there.
template <class Random>
BoxCase box_case(Random& random, int reach, int pace) {
  BoxCase c;
  const float place = wild_power(random, -reach, reach), size = place * wild_power(random, -30, 2);
  const Vec3 centre = random.in_box(Vec3{-place}, Vec3{place});
  c.box.extend(random.below(8) ? centre + random.in_box(Vec3{-size}, Vec3{size}) : centre);
  c.box.extend(random.below(8) ? centre + random.in_box(Vec3{-size}, Vec3{size}) : centre);
  c.ray.origin = random.in_box(Vec3{-4 * place}, Vec3{4 * place});
  Vec3 aim;
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint32_t where = random.below(3);
    aim[axis] = where == 0   ? c.box.lo[axis]
                : where == 1 ? c.box.hi[axis]
                             : random.uniform(c.box.lo[axis], c.box.hi[axis]);
    if (random.below(8) == 0) c.ray.origin[axis] = aim[axis];
  }
  c.ray.direction = aim - c.ray.origin;
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint32_t how = random.below(6);
    if (how == 0) c.ray.direction[axis] = std::nextafter(c.ray.direction[axis], kInfinity);
    if (how == 1) c.ray.direction[axis] = std::nextafter(c.ray.direction[axis], -kInfinity);
    if (random.below(32) == 0) c.ray.direction[axis] = random.below(2) ? 0.0f : -0.0f;
  }
  c.ray.direction = c.ray.direction * wild_power(random, -pace, pace);
  return c;
}

}  // namespace carousel::accel
