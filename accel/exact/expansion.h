#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace carousel::accel {

/// An exact sum of doubles: components of rising magnitude that share no bits (J. R. Shewchuk, "Adaptive precision
/// floating-point arithmetic and fast robust geometric predicates", 1997, section 2). Exact as long as nothing
/// overflows and no product has bits below 2^-1074, and there must be no contraction.
class Expansion {
 public:
  /// Components that fit. Nonadjacent ones (Shewchuk's theorem 10) have a bit of their own and one between: enough
  /// for a span of 1,150 bits.
  static constexpr std::size_t kCapacity = 576;

  // The first element is never read before it is written.
  Expansion() {}  // NOLINT(modernize-use-equals-default,cppcoreguidelines-pro-type-member-init)

  /// Grow-Expansion, figure 6 there, with zeros left out.
  void add(double b) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const double e = part_[i], sum = b + e;
      const double rounded = sum - b, lost = (b - (sum - rounded)) + (e - rounded);  // Two-Sum, figure 4
      b = sum;
      if (lost != 0) part_[kept++] = lost;
    }
    if (b != 0) part_[kept++] = b;
    count_ = kept;
  }
  void add(const Expansion& other) {
    for (std::size_t i = 0; i < other.count_; ++i) add(other.part_[i]);
  }
  /// Adds a * b: Two-Product of T. J. Dekker 1971, figure 9 there.
  void add_product(double a, double b) {
    const double product = a * b, a_high = high_half(a), b_high = high_half(b);
    const double a_low = a - a_high, b_low = b - b_high;
    const double missing = ((product - a_high * b_high) - a_low * b_high) - a_high * b_low;
    add(a_low * b_low - missing);
    add(product);
  }
  /// Adds `other` * b.
  void add_product(const Expansion& other, double b) {
    for (std::size_t i = 0; i < other.count_; ++i) add_product(other.part_[i], b);
  }

  /// -1, 0 or 1: the largest component outweighs the others.
  int sign() const { return count_ == 0 ? 0 : part_[count_ - 1] > 0 ? 1 : -1; }
  /// The sum, wrong by at most 4 * 2^-53 of itself.
  double estimate() const {
    double sum = 0;
    for (std::size_t i = 0; i < count_; ++i) sum += part_[i];
    return sum;
  }

 private:
  static double high_half(double a) {
    const double c = 0x8000001p0 * a;  // 2^27 + 1
    return c - (c - a);
  }

  std::array<double, kCapacity> part_;
  std::size_t count_ = 0;
};

}  // namespace carousel::accel
