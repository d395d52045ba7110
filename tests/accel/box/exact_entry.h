#pragma once

#include <algorithm>
#include <cmath>

#include <boost/multiprecision/cpp_int.hpp>

#include "core/types/aabb.h"
#include "core/types/ray.h"

namespace carousel::accel {

/// Sign of the exact distance at which a ray enters a box, at least tmin, minus `x`, by big integers on the given
/// floats. The ray meets the box.
inline int compare_entry(const Ray& ray, const Aabb& box, float x) {
  using Int = boost::multiprecision::cpp_int;
  constexpr int kScale = 149;  // every float is a whole number of 2^-149
  const auto integer = [](float value) { return Int(std::ldexp(double{value}, kScale)); };
  int sign = Int(integer(ray.tmin) - integer(x)).sign();
  for (int axis = 0; axis < 3; ++axis) {
    const float d = ray.direction[axis];
    if (d == 0) continue;
    const Int plane = integer(d > 0 ? box.lo[axis] : box.hi[axis]) - integer(ray.origin[axis]);
    const Int beyond = Int(plane << kScale) - integer(x) * integer(d);
    sign = std::max(sign, d > 0 ? beyond.sign() : -beyond.sign());
  }
  return sign;
}

}  // namespace carousel::accel
