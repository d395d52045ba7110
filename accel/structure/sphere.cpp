#include "accel/structure/sphere.h"

#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

namespace carousel::accel {

bool cross_sphere(const Vec3& origin, const Vec3& direction, const Vec3& centre, float radius, SphereCrossing& out) {
  const DVec3 from = DVec3(origin) - DVec3(centre), d(direction);
  const double r = radius, a = glm::dot(d, d), b = -glm::dot(from, d);
  if (!(a > 0) || !(r > 0)) return false;
  const DVec3 nearest = from + (b / a) * d;  // to the centre, of the line's points
  const double half_chord2 = r * r - glm::dot(nearest, nearest);
  if (!(half_chord2 >= 0)) return false;
  const double root = std::sqrt(a * half_chord2), q = b + std::copysign(root, b);
  const double c = glm::dot(from, from) - r * r;
  const double one = q / a, other = q != 0 ? c / q : one;
  out.t[0] = std::fmin(one, other);
  out.t[1] = std::fmax(one, other);
  for (int k = 0; k < 2; ++k) {
    const DVec3 at = from + out.t[k] * d;
    out.normal[k] = at / std::sqrt(glm::dot(at, at));
  }
  return true;
}

Aabb box_around(const Vec3& centre, const Vec3& reach) {
  Aabb box;
  constexpr float kFar = std::numeric_limits<float>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double lo = double{centre[axis]} - reach[axis], hi = double{centre[axis]} + reach[axis];
    box.lo[axis] = static_cast<float>(lo);
    box.hi[axis] = static_cast<float>(hi);
    if (double{box.lo[axis]} > lo) box.lo[axis] = std::nextafter(box.lo[axis], -kFar);
    if (double{box.hi[axis]} < hi) box.hi[axis] = std::nextafter(box.hi[axis], kFar);
  }
  return box;
}

}  // namespace carousel::accel
