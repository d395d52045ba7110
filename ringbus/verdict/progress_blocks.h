#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "ringbus/results/cycle_result.h"

namespace carousel::ringbus {

// A run's progress between two counts of completed rays, cut into blocks of equal numbers of rays, from whose
// differences errors are estimated.

inline constexpr std::size_t kProgressBlocks = 16;

/// The value at a place of a run's progress, between samples by a straight line. `places`: that of each sample,
/// ascending; `value` takes a sample.
template <class Places, class Value>
double at_place(const cycle::CycleResult& result, const Places& places, double place, const Value& value) {
  const std::vector<cycle::ProgressSample>& all = result.progress;
  if (all.empty()) return 0;
  std::size_t after = 0;
  for (std::size_t end = all.size(); after < end;) {
    const std::size_t middle = after + (end - after) / 2;
    if (places(middle) < place)
      after = middle + 1;
    else
      end = middle;
  }
  if (after == all.size()) return value(all.back());
  const double reached = value(all[after]);
  if (after == 0) return reached;
  const double before = value(all[after - 1]), begin = places(after - 1);
  return before + (place - begin) / (places(after) - begin) * (reached - before);
}

/// The value at which `completed` rays had been completed.
template <class Value>
double at_count(const cycle::CycleResult& result, std::uint64_t completed, const Value& value) {
  const auto places = [&](std::size_t i) { return static_cast<double>(result.progress[i].completed); };
  return at_place(result, places, static_cast<double>(completed), value);
}

inline constexpr std::uint64_t kLooks = 16, kAllLooks = kProgressBlocks * kLooks;

/// The means of blocks over what `look` finds at each of kAllLooks places. Times at which two schedules complete the
/// same number of rays differ by chance; their means differ less.
template <class Look>
std::vector<double> means_of_looks(const Look& look) {
  std::vector<double> out;
  for (std::uint64_t block = 0; block < kProgressBlocks; ++block) {
    double sum = 0;
    for (std::uint64_t i = 0; i < kLooks; ++i) sum += look(block * kLooks + i);
    out.push_back(sum / static_cast<double>(kLooks));
  }
  return out;
}

/// The mean of a value in each of the blocks of equal numbers of rays that those from `begin` to `end` are cut into.
template <class Value>
std::vector<double> block_means(const cycle::CycleResult& result, std::uint64_t begin, std::uint64_t end,
                                const Value& value) {
  return means_of_looks([&](std::uint64_t look) {
    return at_count(result, begin + (end - begin) * (2 * look + 1) / (2 * kAllLooks), value);
  });
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
