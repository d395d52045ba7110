#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace carousel {

/// Counts of latencies in cycles or nanoseconds, log-linear: each value by itself up to 2048, from there on 1024
/// classes to a doubling (within 0.1 %). Grows with the largest value.
class LatencyHistogram {
 public:
  void add(std::uint64_t latency) {
    const std::size_t i = index(latency);
    if (i >= counts_.size()) counts_.resize(i + 1);
    ++counts_[i];
    ++count_;
    sum_ += latency;
    if (latency > max_) max_ = latency;
  }
  void add(const LatencyHistogram& o) {
    if (o.counts_.size() > counts_.size()) counts_.resize(o.counts_.size());
    for (std::size_t i = 0; i < o.counts_.size(); ++i) counts_[i] += o.counts_[i];
    count_ += o.count_;
    sum_ += o.sum_;
    if (o.max_ > max_) max_ = o.max_;
  }

  std::uint64_t count() const { return count_; }
  std::uint64_t sum() const { return sum_; }
  std::uint64_t max() const { return max_; }
  double mean() const { return count_ == 0 ? 0 : static_cast<double>(sum_) / static_cast<double>(count_); }
  /// The least latency that at least the part `q` of all does not exceed, or its class's least; 0 for none.
  std::uint64_t quantile(double q) const {
    const double wanted = q * static_cast<double>(count_);
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      seen += counts_[i];
      if (seen > 0 && static_cast<double>(seen) >= wanted) return least(i);
    }
    return max_;
  }
  friend bool operator==(const LatencyHistogram&, const LatencyHistogram&) = default;

 private:
  static constexpr int kBits = 10;  // a doubling above the exact values has 2^kBits classes
  static constexpr std::size_t kClasses = std::size_t{1} << kBits;

  static std::size_t index(std::uint64_t latency) {
    if (latency < 2 * kClasses) return latency;
    const int shift = std::bit_width(latency) - 1 - kBits;
    return static_cast<std::size_t>(shift) * kClasses + (latency >> shift);
  }
  static std::uint64_t least(std::size_t i) {
    if (i < 2 * kClasses) return i;
    const std::size_t shift = i / kClasses - 1;
    return (i - shift * kClasses) << shift;
  }

  std::vector<std::uint64_t> counts_;
  std::uint64_t count_ = 0;
  std::uint64_t sum_ = 0, max_ = 0;
};

}  // namespace carousel
