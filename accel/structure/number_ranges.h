#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace carousel::accel {

/// Ranges of numbers, one behind another from 0 on: which one a number is in, and its place there.
class NumberRanges {
 public:
  struct Place {
    std::uint32_t range, index;
  };

  /// Appends a range that begins at `first`. The first one begins at 0, and beginnings do not descend.
  void add(std::uint32_t first) { first_.push_back(first); }
  std::size_t count() const { return first_.size(); }
  /// Precondition: `number` is less than the end of the last range. A range that is empty has none.
  Place place(std::uint32_t number) const {
    const auto range =
        static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), number) - first_.begin() - 1);
    return {static_cast<std::uint32_t>(range), number - first_[range]};
  }

 private:
  std::vector<std::uint32_t> first_;
};

}  // namespace carousel::accel
