#include "ringbus/stress/paired_rates.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace carousel::ringbus::stress {

namespace {

/// Number of the least and greatest values to leave out at either end, so that the rest holds the median with
/// kConfidence. At least kLeastPairs values.
std::size_t left_out(std::size_t values) {
  // The median is below the value of rank j (from 0) if at most j of the values are below it: a binomial tail.
  const double outside = (1 - PairedDifference::kConfidence) / 2;
  double term = std::pow(0.5, static_cast<double>(values)), tail = term;
  std::size_t j = 0;
  while (true) {
    term *= static_cast<double>(values - j) / static_cast<double>(j + 1);
    if (tail + term > outside) return j;
    tail += term;
    ++j;
  }
}

}  // namespace

PairedDifference compare_pairs(std::span<const RatePair> pairs) {
  std::vector<double> ratios;
  for (const RatePair& pair : pairs)
    if (pair.first > 0 && pair.second > 0) ratios.push_back(pair.first / pair.second);
  PairedDifference out;
  out.pairs = ratios.size();
  if (ratios.empty()) return out;
  std::sort(ratios.begin(), ratios.end());
  out.wins = static_cast<std::size_t>(std::count_if(ratios.begin(), ratios.end(), [](double r) { return r > 1; }));
  out.ratio = (ratios[(ratios.size() - 1) / 2] + ratios[ratios.size() / 2]) / 2;
  if (ratios.size() < PairedDifference::kLeastPairs) return out;
  const std::size_t skipped = left_out(ratios.size());
  out.least = ratios[skipped];
  out.most = ratios[ratios.size() - 1 - skipped];
  out.first_is_faster = out.least > 1;
  out.second_is_faster = out.most < 1;
  return out;
}

}  // namespace carousel::ringbus::stress
