#pragma once

#include <cmath>
#include <cstdint>

namespace carousel {

// Written here for the reason that exponential.h gives. The errors are a few units of the last place of a double, so
// that results rounded to float are nearly always the nearest. Samples of paths take that of
// shading/math/trigonometry.h: in float and of full turns, with no angle to reduce.

struct SinCos64 {
  double sin, cos;
};

/// Of an angle in radians; NaN if it is not finite.
inline SinCos64 sin_cos(double angle) {
  constexpr double kTurn = 6.28318530717958647693, kLargest = 0x1p25;
  if (!(std::fabs(angle) < kLargest)) angle = std::fmod(angle, kTurn);
  if (std::isnan(angle)) return {angle, angle};
  // A quarter of a turn in parts of 27 bits, whose multiples are exact (W. Cody and W. Waite, Software Manual for the
  // Elementary Functions, 1980).
  constexpr double kQuarter[3] = {0x1.921fb54p+0, 0x1.10b461p-30, 0x1.a62633145c06ep-58};
  const double nearest = std::floor(angle * 0.63661977236758134308 + 0.5);
  const double x = ((angle - nearest * kQuarter[0]) - nearest * kQuarter[1]) - nearest * kQuarter[2];
  const double xx = x * x;  // |x| <= pi / 4
  double s = 1, c = 1;
  for (int k = 19; k >= 3; k -= 2) {
    s = 1 - xx / (k * (k - 1)) * s;
    c = 1 - xx / ((k - 1) * (k - 2)) * c;
  }
  s *= x;
  switch (static_cast<std::int64_t>(nearest) & 3) {
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

inline float sin_float(float angle) {
  return static_cast<float>(sin_cos(double{angle}).sin);
}
inline float cos_float(float angle) {
  return static_cast<float>(sin_cos(double{angle}).cos);
}
inline double tan_double(double angle) {
  const SinCos64 of = sin_cos(angle);
  return of.sin / of.cos;
}

/// The angle of (x, y) from the x axis towards the y axis, in turns, -1/2 to 1/2; 0 for (0, 0). The
/// error is below 1e-12 of a turn.
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

}  // namespace carousel
