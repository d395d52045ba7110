#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace carousel::shading {

/// Chooses among items in proportion to their weights, by binary search in 32-bit cumulative thresholds.
/// The probability of an item is *exactly* its share of the 2^32 words, rounding included, so that weights
/// computed from it leave no bias. A choice from an ordered word keeps the strata of the words.
class LightChoice {
 public:
  LightChoice() = default;
  /// Weights are >= 0 and finite; if all are 0, nothing can be chosen. Words have random upper `bits`, 1 to 32, and
  /// each probability is a multiple of 2^-bits.
  explicit LightChoice(std::span<const float> weights, unsigned bits = 32);

  bool empty() const { return thresholds_.empty(); }
  std::size_t size() const { return thresholds_.size(); }  ///< items; 0 if empty
  /// Precondition: !empty().
  std::uint32_t choose(std::uint32_t word) const;
  float probability(std::uint32_t item) const;
  /// Calls `visit(index)` for each threshold that choose() compares with the word.
  template <class Visit>
  std::uint32_t choose(std::uint32_t word, const Visit& visit) const {
    const auto after = std::upper_bound(thresholds_.begin(), thresholds_.end(), word,
                                        [&](std::uint32_t key, const std::uint32_t& threshold) {
                                          visit(static_cast<std::uint32_t>(&threshold - thresholds_.data()));
                                          return key < threshold;
                                        });
    return static_cast<std::uint32_t>(after - thresholds_.begin() - 1);
  }
  /// The words that choose an item: from the first to below the second; none of an item beyond the last.
  std::pair<std::uint64_t, std::uint64_t> words_of(std::uint32_t item) const;

 private:
  std::vector<std::uint32_t> thresholds_;  // item i owns words [thresholds_[i], thresholds_[i + 1])
};

}  // namespace carousel::shading
