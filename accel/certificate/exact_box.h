#pragma once

#include <cmath>

#include <boost/multiprecision/cpp_int.hpp>

#include "accel/certificate/big_quotient.h"
#include "core/types/aabb.h"
#include "core/types/ray.h"

namespace carousel::accel {

/// The interval of a ray in a closed box, decided by big integers on the given floats.
class ExactBox {
 public:
  ExactBox(const Ray& ray, const Aabb& box, float tmax)
      : endless_(std::isinf(tmax)), near_{integer(ray.tmin), 1}, far_{endless_ ? Int(0) : integer(tmax), 1} {
    for (int axis = 0; axis < 3; ++axis) {
      const Int o = integer(ray.origin[axis]), d = integer(ray.direction[axis]);
      const Int lo = integer(box.lo[axis]) - o, hi = integer(box.hi[axis]) - o;
      if (d == 0) {
        beside_ |= lo > 0 || hi < 0;
        continue;
      }
      const int sign = d.sign();
      const Int scaled_lo = Int(lo * sign) << kScale, scaled_hi = Int(hi * sign) << kScale, size = d * sign;
      const Fraction entry{sign > 0 ? scaled_lo : scaled_hi, size}, exit{sign > 0 ? scaled_hi : scaled_lo, size};
      if (less(near_, entry)) near_ = entry;
      if (endless_ || less(exit, far_)) far_ = exit, endless_ = false;
    }
  }

  bool hit() const { return !beside_ && (endless_ || !less(far_, near_)); }
  /// The exact entry, rounded; never below tmin.
  double entry() const { return std::ldexp(big_quotient(near_.top, near_.bottom), -kScale); }

 private:
  using Int = boost::multiprecision::cpp_int;
  struct Fraction {  // times 2^kScale; bottom > 0
    Int top, bottom;
  };
  static constexpr int kScale = 149;

  static Int integer(float x) { return Int(std::ldexp(double{x}, kScale)); }
  static bool less(const Fraction& a, const Fraction& b) { return a.top * b.bottom < b.top * a.bottom; }

  bool endless_;  // far_ says nothing yet
  bool beside_ = false;
  Fraction near_, far_;
};

}  // namespace carousel::accel
