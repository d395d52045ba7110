#pragma once

namespace carousel {

/// A gain below this fraction is not worth a verdict.
inline constexpr double kWorthIt = 0.05;

/// True if a verdict may name a class of parts that gains `gain`, whose interval of confidence begins at `low`: it is
/// worth a verdict, and not noise.
constexpr bool worth_naming(double gain, double low) {
  return gain >= kWorthIt && low > 0;
}

}  // namespace carousel
