#pragma once

#include <cmath>

namespace carousel::shading {

struct SinCos {
  float sin, cos;
};

/// Sine and cosine of a number of full turns, |turns| < 2^20; the error is about 1e-7. Written here, because glibc
/// picks another implementation of sinf and cosf on machines with fused multiply-add, whose last bit may differ. For
/// samples of paths; angles of files may be large, and take that of core/numeric/trigonometry.h.
inline SinCos sin_cos_turns(float turns) {
  const float nearest = std::floor(turns * 4.0f + 0.5f);
  const float x = (turns - nearest * 0.25f) * 6.28318531f;  // in [-pi/4, pi/4]
  const float xx = x * x;
  const float s = x + x * xx * (-1.0f / 6 + xx * (1.0f / 120 + xx * (-1.0f / 5040 + xx * (1.0f / 362880))));
  const float c = 1.0f + xx * (-0.5f + xx * (1.0f / 24 + xx * (-1.0f / 720 + xx * (1.0f / 40320))));
  switch (static_cast<int>(nearest) & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

}  // namespace carousel::shading
