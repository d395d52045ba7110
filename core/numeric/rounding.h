#pragma once

namespace carousel {

/// Bound of the error of one rounding to float, relative to the result.
inline constexpr double kUnitRoundoff = 0x1p-24;

/// Bound of the error of n roundings together (Higham, "Accuracy and Stability of Numerical Algorithms", 2002,
/// section 3.1).
constexpr double gamma(int n) {
  return n * kUnitRoundoff / (1 - n * kUnitRoundoff);
}

}  // namespace carousel
