#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>

namespace carousel {

// The two environment variables by which script/soak and builds with sanitizers change random tests.

/// Where random numbers start: 1, or CAROUSEL_SEED, so that each round of the soak draws new cases and a failure can be
/// repeated.
inline std::uint32_t run_seed() {
  const char* seed = std::getenv("CAROUSEL_SEED");
  return seed != nullptr ? static_cast<std::uint32_t>(std::strtoull(seed, nullptr, 10)) : 1u;
}

/// CAROUSEL_EFFORT, by which numbers of random cases are multiplied: 1 unless it is set. script/test runs with 0.25,
/// and with 0.1 under sanitizers, the soak with more than 1.
inline double run_effort() {
  const char* effort = std::getenv("CAROUSEL_EFFORT");
  return effort != nullptr ? std::atof(effort) : 1.0;
}

/// `cases` times the effort, but at least `least`, below which the test would prove nothing.
inline int scaled(int cases, int least = 1) {
  return std::max(least, static_cast<int>(cases * run_effort()));
}

}  // namespace carousel
