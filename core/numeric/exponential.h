#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace carousel {

// Written here, because glibc's expf and powf use fused multiply-add where the machine has it, and their last bit may
// then differ. The functions are evaluated in double with an error of about 1e-9, and rounded to float once.

/// 2^x; 0 below -126 (no denormals), infinity from 128 on.
inline float exp2_float(double x) {
  if (!(x > -126.0)) return 0.0f;
  if (x >= 128.0) return INFINITY;
  const double whole = std::floor(x + 0.5);
  const double y = (x - whole) * 0.69314718055994530942;  // |y| <= ln(2) / 2
  double series = 1.0;
  for (int k = 9; k >= 1; --k) series = 1.0 + series * (y / k);
  const auto scale = std::bit_cast<double>((static_cast<std::uint64_t>(static_cast<std::int64_t>(whole) + 1023)) << 52);
  return static_cast<float>(series * scale);
}

/// Base-2 logarithm of a normal number, x > 0, by a series up to the power `last` of a number below 0.172.
inline double log2_series(double x, int last) {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  auto exponent = static_cast<int>(bits >> 52) - 1023;
  double m = std::bit_cast<double>((bits & 0x000fffffffffffffull) | 0x3ff0000000000000ull);  // 1 to 2
  if (m > 1.41421356237309504880) {
    m *= 0.5;
    ++exponent;
  }
  const double r = (m - 1.0) / (m + 1.0), rr = r * r;  // |r| < 0.172
  double series = 0.0;
  for (int k = last; k >= 1; k -= 2) series = 1.0 / k + rr * series;
  return exponent + 2.0 * r * series * 1.44269504088896340736;
}
inline double log2_double(double x) {
  return log2_series(x, 13);
}

inline float exp_float(float x) {
  return exp2_float(double{x} * 1.44269504088896340736);
}

/// x^y for x >= 0; 0^y is 0.
inline float pow_float(float x, float y) {
  return x > 0.0f ? exp2_float(log2_double(double{x}) * double{y}) : 0.0f;
}

// With a relative error of about 1e-15 times the size of the exponent.

/// 2^x; 0 below -1022 (no denormals), infinity from 1024 on.
inline double exp2_precise(double x) {
  if (!(x > -1022.0)) return 0.0;
  if (x >= 1024.0) return INFINITY;
  const double whole = std::floor(x + 0.5);
  const double y = (x - whole) * 0.69314718055994530942;
  double series = 1.0;
  for (int k = 14; k >= 1; --k) series = 1.0 + series * (y / k);
  return std::ldexp(series, static_cast<int>(whole));
}
inline double exp_precise(double x) {
  return exp2_precise(x * 1.44269504088896340736);
}
/// Natural logarithm of a normal number, x > 0.
inline double log_precise(double x) {
  return log2_series(x, 23) * 0.69314718055994530942;
}
/// x^y for x >= 0; 0^y is 0.
inline double pow_precise(double x, double y) {
  return x > 0.0 ? exp2_precise(log2_series(x, 23) * y) : 0.0;
}

}  // namespace carousel
