#pragma once

#include "core/types/vec.h"

namespace carousel::accel {

// The traditional transform: one inverse matrix M^-1 = (R^-1, -R^-1 T), its translation folded in, applied to the
// point. Far from the world's origin R^-1 p and R^-1 T are both large and nearly opposite: the difference keeps the
// rounding errors of both and few of their digits (US 12394134, background).

/// -R^-1 T, computed in double and rounded once: the matrix is as good as floats can make it.
inline Vec3 folded_translation(const DMat3& inverse, const Vec3& translation) {
  DVec3 out(0.0);
  for (int row = 0; row < 3; ++row)
    for (int c = 0; c < 3; ++c) out[row] -= inverse[c][row] * double(translation[c]);
  return Vec3(out);
}

[[gnu::always_inline]] inline Vec3 inverse_matrix(const Mat3& inverse, const Vec3& folded, const Vec3& p) {
  Vec3 out;
  for (int row = 0; row < 3; ++row)
    out[row] = inverse[0][row] * p.x + inverse[1][row] * p.y + inverse[2][row] * p.z + folded[row];
  return out;
}

}  // namespace carousel::accel
