#pragma once

namespace carousel {

/// A gain below this fraction is not worth a verdict.
inline constexpr double kWorthIt = 0.05;

/// Gains that differ by no more than this are tied.
inline constexpr double kTie = 0.03;

/// By which gains are compared for a verdict: the lower end of the interval counts for a third, since the greatest of
/// several uncertain gains is likely to be one that was overestimated.
constexpr double likely_gain(double gain, double low) {
  return (2 * gain + low) / 3;
}

/// True if a verdict may name a class of parts that gains `gain`, whose interval of confidence begins at `low`: it is
/// worth a verdict, and likely to gain. A verdict says `probably` of one whose interval reaches below 0.
constexpr bool worth_naming(double gain, double low) {
  return gain >= kWorthIt && likely_gain(gain, low) > 0;
}

}  // namespace carousel
