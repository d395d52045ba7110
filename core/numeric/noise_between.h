#pragma once

#include <cmath>
#include <optional>

namespace carousel {

/// The noise of the difference of two machines, from that of each: the difference of two runs of one machine, which is
/// the root of 2 times the deviation of a run. It has the mean of both squares. Where only one is known, both are taken
/// to have it; absent where none is.
inline std::optional<double> noise_between(std::optional<double> a, std::optional<double> b) {
  if (!a || !b) return a ? a : b;
  return std::sqrt((*a * *a + *b * *b) / 2);
}

}  // namespace carousel
