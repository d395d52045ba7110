#pragma once

#include <cstddef>
#include <span>

namespace carousel::ringbus::stress {

/// The rates of two candidates that ran one right after the other.
struct RatePair {
  double first = 0, second = 0;
};

/// Tells whether pairs of runs show one of two candidates to be faster. Load of the host that changes slowly falls on
/// both runs of a pair, so only the ratios within pairs are looked at, and nothing is assumed about their distribution:
/// the interval of their median is that between order statistics, by the sign test (W. J. Conover, Practical
/// Nonparametric Statistics, 3rd ed. 1999, sections 3.2 and 3.4).
///
/// The pairs must be of runs made after the two candidates were chosen. Runs by which the best of many was chosen
/// favour it by chance.
struct PairedDifference {
  /// An interval holds the median with at least this probability.
  static constexpr double kConfidence = 0.99;
  /// With fewer pairs no interval is that sure.
  static constexpr std::size_t kLeastPairs = 8;

  std::size_t pairs = 0;
  std::size_t wins = 0;          ///< pairs in which the first candidate was faster
  double ratio = 1;              ///< median of first / second
  double least = 0, most = 0;    ///< interval of the median; 0 to 0 with fewer than kLeastPairs
  bool first_is_faster = false;  ///< the whole interval is above 1
  bool second_is_faster = false;
};

/// Pairs with a rate that is not above 0 do not count.
PairedDifference compare_pairs(std::span<const RatePair> pairs);

}  // namespace carousel::ringbus::stress
