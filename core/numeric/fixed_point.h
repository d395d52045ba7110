#pragma once

#include <cmath>
#include <cstdint>

namespace carousel {

// Radiance as signed 64-bit fixed point with 28 fraction bits. Integers add up to the same sum in any order,
// floats do not; this is what makes the image independent of the order in which rays complete.

inline constexpr double kFixedPointOne = 0x1p28;
/// One term is limited to this (radiance 2^20), so that 2^15 saturated terms still fit their 64-bit sum.
inline constexpr std::int64_t kFixedPointMax = std::int64_t{1} << 48;

/// Nearest fixed-point value, halves away from zero. A value outside +-kFixedPointMax, infinities included,
/// becomes the nearer limit and NaN becomes 0; each such value adds 1 to `saturated`.
inline std::int64_t to_fixed_point(float value, std::uint64_t& saturated) {
  const double scaled = static_cast<double>(value) * kFixedPointOne;  // exact: a power of two
  if (!(std::abs(scaled) <= static_cast<double>(kFixedPointMax))) {
    ++saturated;
    if (scaled > 0) return kFixedPointMax;
    return scaled < 0 ? -kFixedPointMax : 0;  // NaN compares false with everything
  }
  return static_cast<std::int64_t>(scaled + (scaled < 0 ? -0.5 : 0.5));
}

/// Limits a sum of terms as to_fixed_point() limits one.
inline std::int64_t clamp_fixed_point(std::int64_t value, std::uint64_t& saturated) {
  if (value >= -kFixedPointMax && value <= kFixedPointMax) return value;
  ++saturated;
  return value < 0 ? -kFixedPointMax : kFixedPointMax;
}

/// sum / count, rounded to float once.
inline float mean_of_fixed_point(std::int64_t sum, std::int64_t count) {
  return static_cast<float>(static_cast<double>(sum) / (kFixedPointOne * static_cast<double>(count)));
}

}  // namespace carousel
