#pragma once

#include "core/types/vec.h"

namespace carousel::accel {

// US 12394134, "Transformation of data in a ray tracing system", claim 1: the translation is undone first, then the
// linear mapping. Cancellation happens in the subtraction, where it is exact or nearly so, and not after a product
// with a large matrix entry has been rounded.

/// M^-1 v of a linear mapping, as a direction needs it.
[[gnu::always_inline]] inline Vec3 linear_step(const Mat3& inverse, const Vec3& v) {
  Vec3 out;
  for (int row = 0; row < 3; ++row) out[row] = inverse[0][row] * v.x + inverse[1][row] * v.y + inverse[2][row] * v.z;
  return out;
}

/// R^-1 (p - T) in float.
[[gnu::always_inline]] inline Vec3 two_step(const Mat3& inverse, const Vec3& translation, const Vec3& p) {
  const Vec3 offset{p.x - translation.x, p.y - translation.y, p.z - translation.z};
  return linear_step(inverse, offset);
}

/// As linear_step(), but in double with the one rounding to float at the end. `inverse` + `rest` is R^-1 to 48 bits:
/// two floats hold so many.
[[gnu::always_inline]] inline Vec3 linear_step_double(const Mat3& inverse, const Mat3& rest, const DVec3& v) {
  Vec3 out;
  for (int row = 0; row < 3; ++row) {
    const double x = (double(inverse[0][row]) + rest[0][row]) * v.x, y = (double(inverse[1][row]) + rest[1][row]) * v.y,
                 z = (double(inverse[2][row]) + rest[2][row]) * v.z;
    out[row] = static_cast<float>(x + y + z);
  }
  return out;
}

[[gnu::always_inline]] inline Vec3 two_step_double(const Mat3& inverse, const Mat3& rest, const Vec3& translation,
                                                   const Vec3& p) {
  // The difference of two floats need not fit a double, but its error then is 2^-53 of it.
  return linear_step_double(inverse, rest, DVec3(p) - DVec3(translation));
}

}  // namespace carousel::accel
