#pragma once

namespace carousel {

/// What one rounding to float is wrong by at most, relative to the result.
inline constexpr double kUnitRoundoff = 0x1p-24;

/// What n roundings are wrong by together (Higham, "Accuracy and Stability of Numerical Algorithms", 2002,
/// section 3.1).
constexpr double gamma(int n) {
  return n * kUnitRoundoff / (1 - n * kUnitRoundoff);
}

}  // namespace carousel
