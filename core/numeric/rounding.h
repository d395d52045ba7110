#pragma once

#include <cmath>
#include <limits>

namespace carousel {

/// Bound of the error of one rounding to float, relative to the result.
inline constexpr double kUnitRoundoff = 0x1p-24;

/// Bound of the error of n roundings together (Higham, "Accuracy and Stability of Numerical Algorithms", 2002,
/// section 3.1).
constexpr double gamma(int n) {
  return n * kUnitRoundoff / (1 - n * kUnitRoundoff);
}

/// The least float that is not below `x`; NaN stays.
inline float rounded_up(double x) {
  const float nearest = static_cast<float>(x);
  return double{nearest} < x ? std::nextafter(nearest, std::numeric_limits<float>::infinity()) : nearest;
}

/// The greatest float that is not above `x`; NaN stays.
inline float rounded_down(double x) {
  return -rounded_up(-x);
}

}  // namespace carousel
