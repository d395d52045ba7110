#pragma once

#include <cmath>

namespace carousel::shading {

// Angles in double, with errors below 1e-12 of a turn; written here for the reason that trigonometry.h gives.

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

/// The angle of (x, y) from the x axis towards the y axis, in turns, -1/2 to 1/2; 0 for (0, 0).
inline double angle_in_turns(double y, double x) {
  constexpr double kTurnsPerRadian = 0.15915494309189533577, kTanOfEighth = 0.41421356237309504880;
  const double a = std::abs(x), b = std::abs(y);
  if (!(a > 0.0) && !(b > 0.0)) return 0.0;
  const bool swap = b > a;
  const double t = swap ? a / b : b / a;  // 0 to 1
  const bool far = t > kTanOfEighth;
  const double r = far ? (t - 1.0) / (t + 1.0) : t, rr = r * r;  // |r| up to 0.4143
  double series = 0.0;
  for (int k = 31; k >= 1; k -= 2) series = 1.0 / k - rr * series;
  double turns = r * series * kTurnsPerRadian + (far ? 0.125 : 0.0);
  if (swap) turns = 0.25 - turns;
  if (x < 0.0) turns = 0.5 - turns;
  return y < 0.0 ? -turns : turns;
}

}  // namespace carousel::shading
