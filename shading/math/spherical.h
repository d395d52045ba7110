#pragma once

namespace carousel::shading {

// In double, with an error below 1e-12; written here for the reason that trigonometry.h gives.

/// Cosine of `halves` half turns, 0 to 1.
inline double cos_half_turns(double halves) {
  constexpr double kHalfTurn = 3.14159265358979323846;
  const bool behind = halves > 0.5;
  const double x = behind ? 1.0 - halves : halves;  // 0 to 1/2
  const bool steep = x > 0.25;
  const double angle = kHalfTurn * (steep ? 0.5 - x : x), square = angle * angle;  // angle to pi / 4
  // Taylor: of the sine from 1 / 19!, or of the cosine from 1 / 18!.
  double series = 1.0;
  for (int k = steep ? 19 : 18; k > 1; k -= 2) series = 1.0 - series * square / (k * (k - 1));
  const double cosine = steep ? angle * series : series;
  return behind ? -cosine : cosine;
}

}  // namespace carousel::shading
