#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace carousel::shading {

/// Chooses among items in proportion to their weights, by binary search in 32-bit cumulative thresholds.
/// The probability of an item is *exactly* its share of the 2^32 words, rounding included, so that weights
/// computed from it leave no bias. A choice from an ordered word keeps the strata of the words.
class LightChoice {
 public:
  LightChoice() = default;
  /// Weights are >= 0 and finite; if all are 0, nothing can be chosen.
  explicit LightChoice(std::span<const float> weights);

  bool empty() const { return thresholds_.empty(); }
  /// Precondition: !empty().
  std::uint32_t choose(std::uint32_t word) const;
  float probability(std::uint32_t item) const;

 private:
  std::vector<std::uint32_t> thresholds_;  // item i owns words [thresholds_[i], thresholds_[i + 1])
};

}  // namespace carousel::shading
