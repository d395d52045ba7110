#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace carousel {

/// Counts of whole numbers in classes that double: class 0 holds 0, class i holds 2^(i-1) to 2^i - 1. Adding is a few
/// instructions, and the size is fixed.
class Log2Histogram {
 public:
  static constexpr std::size_t kClasses = 65;

  void add(std::uint64_t value) {
    ++counts_[static_cast<std::size_t>(std::bit_width(value))];
    sum_ += value;
    max_ = std::max(max_, value);
  }
  Log2Histogram& operator+=(const Log2Histogram& o) {
    for (std::size_t i = 0; i < kClasses; ++i) counts_[i] += o.counts_[i];
    sum_ += o.sum_;
    max_ = std::max(max_, o.max_);
    return *this;
  }

  std::uint64_t count() const {
    std::uint64_t all = 0;
    for (const std::uint64_t count : counts_) all += count;
    return all;
  }
  std::uint64_t sum() const { return sum_; }
  std::uint64_t max() const { return max_; }
  std::uint64_t in_class(std::size_t i) const { return counts_[i]; }
  /// The least value of a class; its greatest is the next one's least minus 1.
  static constexpr std::uint64_t least(std::size_t i) { return i == 0 ? 0 : std::uint64_t{1} << (i - 1); }
  friend bool operator==(const Log2Histogram&, const Log2Histogram&) = default;

 private:
  std::array<std::uint64_t, kClasses> counts_{};
  std::uint64_t sum_ = 0, max_ = 0;
};

}  // namespace carousel
