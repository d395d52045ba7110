#pragma once

#include <bit>
#include <cstdint>

namespace carousel {

/// Divides by a number that stays the same, from 1 on: by a shift if it is a power of two, as widths and sizes of
/// hardware mostly are.
class Divisor {
 public:
  constexpr explicit Divisor(std::uint64_t by)
      : by_(by), shift_(static_cast<std::uint8_t>(std::countr_zero(by))), power_(std::has_single_bit(by)) {}

  constexpr std::uint64_t value() const { return by_; }
  constexpr std::uint64_t quotient(std::uint64_t n) const { return power_ ? n >> shift_ : n / by_; }
  constexpr std::uint64_t remainder(std::uint64_t n) const { return power_ ? n & (by_ - 1) : n % by_; }
  /// The quotient, rounded up.
  constexpr std::uint64_t ceiling(std::uint64_t n) const { return quotient(n + by_ - 1); }

 private:
  std::uint64_t by_;
  std::uint8_t shift_;
  bool power_;
};

}  // namespace carousel
