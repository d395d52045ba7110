#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "ringbus/results/cycle_result.h"

namespace carousel::ringbus {

// A run's progress between two counts of completed rays, cut into blocks of equal numbers of rays, from whose
// differences errors are estimated.

inline constexpr std::size_t kProgressBlocks = 16;

/// The value at which `completed` rays had been completed, between samples by a straight line; `value` takes a sample.
template <class Value>
double at_count(const cycle::CycleResult& result, std::uint64_t completed, const Value& value) {
  const std::vector<cycle::ProgressSample>& all = result.progress;
  const auto after = std::find_if(all.begin(), all.end(), [&](const auto& s) { return s.completed >= completed; });
  if (after == all.end()) return all.empty() ? 0 : value(all.back());
  const double reached = value(*after);
  if (after == all.begin()) return reached;
  const cycle::ProgressSample& before = *(after - 1);
  const double part =
      static_cast<double>(completed - before.completed) / static_cast<double>(after->completed - before.completed);
  return value(before) + part * (reached - value(before));
}

/// The mean of a value in each of the blocks of equal numbers of rays that those from `begin` to `end` are cut into.
/// Times at which two schedules complete the same number of rays differ by chance; their means differ less.
template <class Value>
std::vector<double> block_means(const cycle::CycleResult& result, std::uint64_t begin, std::uint64_t end,
                                const Value& value) {
  constexpr std::uint64_t kLooks = 16;
  std::vector<double> out;
  for (std::size_t block = 0; block < kProgressBlocks; ++block) {
    double sum = 0;
    for (std::uint64_t look = 0; look < kLooks; ++look)
      sum += at_count(
          result, begin + (end - begin) * (2 * (block * kLooks + look) + 1) / (2 * kProgressBlocks * kLooks), value);
    out.push_back(sum / static_cast<double>(kLooks));
  }
  return out;
}

inline double cycle_of(const cycle::ProgressSample& sample) {
  return static_cast<double>(sample.at);
}

inline std::vector<double> steps(const std::vector<double>& values) {
  std::vector<double> out;
  for (std::size_t i = 1; i < values.size(); ++i) out.push_back(values[i] - values[i - 1]);
  return out;
}

/// The standard error of the sum of steps between block means, from the differences between neighbours. If rays take
/// their times independently of each other, with a variance of v for a block, steps have a variance of 2/3 v and, as
/// neighbours share half a block, a covariance of 1/6 v; the squared differences then come to v, as does a step's part
/// of the variance of the sum.
inline double standard_error(std::span<const double> terms) {
  if (terms.size() < 2) return 0;
  double squares = 0;
  for (std::size_t i = 1; i < terms.size(); ++i) squares += (terms[i] - terms[i - 1]) * (terms[i] - terms[i - 1]);
  const double n = static_cast<double>(terms.size());
  return std::sqrt(n / (n - 1) * squares);
}

}  // namespace carousel::ringbus
