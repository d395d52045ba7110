#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace carousel {

// The two environment variables by which script/soak and builds with sanitizers change random tests.

/// Where random numbers start: 1, or CAROUSEL_SEED, so that each round of the soak draws new cases and a failure can be
/// repeated.
inline std::uint32_t run_seed() {
  const char* seed = std::getenv("CAROUSEL_SEED");
  return seed != nullptr ? static_cast<std::uint32_t>(std::strtoull(seed, nullptr, 10)) : 1u;
}

/// CAROUSEL_EFFORT, by which numbers of random cases are multiplied: 1 unless it is set. script/test runs with 0.1, the
/// soak with 1 and more.
inline double run_effort() {
  const char* effort = std::getenv("CAROUSEL_EFFORT");
  return effort != nullptr ? std::atof(effort) : 1.0;
}

/// `cases` times the effort, but at least `least`, below which the test would prove nothing.
inline int scaled(int cases, int least = 1) {
  return std::max(least, static_cast<int>(cases * run_effort()));
}

/// The cases of a table that takes long: all, or where the effort is below 1 every 1 / effort-th, which are others for
/// another seed. For cases that show one rule again on another machine, not for tables whose rows are rules of their
/// own.
template <class Case>
std::vector<Case> some(const std::vector<Case>& cases, std::size_t least = 1) {
  const double effort = std::clamp(run_effort(), 1e-3, 1.0);
  const auto wanted = std::min(cases.size(), std::max(least, static_cast<std::size_t>(effort * cases.size() + 0.5)));
  std::vector<Case> out;
  for (std::size_t i = 0; i < wanted; ++i)
    out.push_back(cases[(run_seed() - 1 + i * cases.size() / wanted) % cases.size()]);
  return out;
}

/// Whether tests run that take long and show a rule on a larger machine, or more often, than another test does: not in
/// script/test. They are run by script/soak, and by hand.
inline bool long_tests_run() {
  return run_effort() >= 1;
}

/// What a test that does not run says.
inline constexpr const char* kInSoak = "takes long: CAROUSEL_EFFORT=1, as in script/soak, runs it";

/// Whether ThreadSanitizer looks on. Tests then take many times as long, and what runs on one thread shows it nothing.
#ifdef __SANITIZE_THREAD__
inline constexpr bool kThreadSanitizer = true;
#else
inline constexpr bool kThreadSanitizer = false;
#endif
inline constexpr const char* kOneThread = "runs on one thread: nothing for ThreadSanitizer";

}  // namespace carousel
