#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <boost/multiprecision/cpp_int.hpp>

namespace carousel::accel {

/// A number integer * 2^exponent of any size: every float and double is one, and so are their sums and products,
/// without rounding. Integers up to 128 bits need no memory of their own.
class Dyadic {
 public:
  using Int = boost::multiprecision::cpp_int;

  Dyadic() = default;
  /// `x` must be finite.
  explicit Dyadic(double x) {
    if (x == 0) return;
    const double mantissa = std::frexp(x, &exponent_);
    auto bits = static_cast<std::int64_t>(std::ldexp(mantissa, 53));
    const int zeros = __builtin_ctzll(static_cast<unsigned long long>(bits));
    integer_ = bits >> zeros;
    exponent_ += zeros - 53;
  }

  Dyadic(Int integer, int exponent) : integer_(std::move(integer)), exponent_(exponent) {}

  int sign() const { return integer_.sign(); }
  const Int& integer() const { return integer_; }
  int exponent() const { return exponent_; }

  Dyadic operator-() const { return Dyadic(Int(-integer_), exponent_); }
  friend Dyadic operator*(const Dyadic& a, const Dyadic& b) {
    return Dyadic(Int(a.integer_ * b.integer_), a.exponent_ + b.exponent_);
  }
  friend Dyadic operator+(const Dyadic& a, const Dyadic& b) {
    if (a.sign() == 0) return b;
    if (b.sign() == 0) return a;
    if (a.exponent_ < b.exponent_) return b + a;
    return Dyadic(Int((a.integer_ << (a.exponent_ - b.exponent_)) + b.integer_), b.exponent_);
  }
  friend Dyadic operator-(const Dyadic& a, const Dyadic& b) { return a + -b; }

 private:
  Int integer_ = 0;
  int exponent_ = 0;
};

/// numerator / denominator as the nearest `Real` (float or double), ties to even, denormals and overflow included.
/// The denominator must not be 0.
template <class Real>
Real rounded_ratio(const Dyadic& numerator, const Dyadic& denominator) {
  using Int = Dyadic::Int;
  using Limits = std::numeric_limits<Real>;
  if (numerator.sign() == 0) return 0;
  const Int n = abs(numerator.integer()), d = abs(denominator.integer());
  const bool negative = numerator.sign() != denominator.sign();
  // A quotient of at least 64 bits, of which the last says whether anything is left: enough for one rounding.
  const int shift = std::max(0, 64 + static_cast<int>(msb(d)) - static_cast<int>(msb(n)) + 1);
  Int quotient, rest;
  divide_qr(Int(n << shift), d, quotient, rest);
  if (rest != 0) quotient = (quotient << 1) | 1;
  const int exponent = numerator.exponent() - denominator.exponent() - shift - (rest != 0);
  constexpr int kLeast = Limits::min_exponent - Limits::digits;  // exponent of the least denormal
  const int top = static_cast<int>(msb(quotient));
  const int drop = std::max(top + 1 - Limits::digits, kLeast - exponent);
  if (drop > top + 1) return negative ? -Real(0) : Real(0);
  Int kept = quotient >> drop;
  const Int lost = quotient - (kept << drop), half = Int(1) << (drop - 1);
  if (lost > half || (lost == half && (kept & 1) != 0)) ++kept;
  const Real magnitude = std::ldexp(static_cast<Real>(static_cast<std::uint64_t>(kept)), exponent + drop);
  return negative ? -magnitude : magnitude;
}

}  // namespace carousel::accel
