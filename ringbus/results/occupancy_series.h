#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace carousel::ringbus {

/// The occupancy of a queue in the course of a run: means over equal numbers of samples, at most kMost of them. When
/// there are too many, neighbours are joined, so a long run costs no more than a short one. The clock is read once an
/// entry.
class OccupancySeries {
 public:
  using Clock = std::chrono::steady_clock;
  struct Entry {
    std::uint64_t sum = 0, samples = 0, most = 0;
    Clock::time_point end{};
  };

  void add(std::uint64_t occupancy) {
    open_.sum += occupancy;
    open_.most = std::max(open_.most, occupancy);
    if (++open_.samples == each_) close();
  }
  /// The complete entries, oldest first.
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  static constexpr std::size_t kMost = 64;

  void close() {
    open_.end = Clock::now();
    entries_.push_back(open_);
    open_ = {};
    if (entries_.size() < kMost) return;
    for (std::size_t i = 0; i < kMost / 2; ++i) {
      const Entry &a = entries_[2 * i], &b = entries_[2 * i + 1];
      entries_[i] = {a.sum + b.sum, a.samples + b.samples, std::max(a.most, b.most), b.end};
    }
    entries_.resize(kMost / 2);
    each_ *= 2;
  }

  std::uint64_t each_ = 32;  // samples of an entry
  Entry open_;
  std::vector<Entry> entries_;
};

}  // namespace carousel::ringbus
