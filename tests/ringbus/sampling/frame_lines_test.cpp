#include "ringbus/sampling/frame_lines.h"

#include <cmath>

#include <gtest/gtest.h>

namespace carousel::ringbus {
namespace {

/// The lines that n rays ask for, if rates have a gamma distribution.
double asked(double lines, double a, double k, double n) {
  return lines * (1 - std::pow(1 + a * n, -k));
}

TEST(FirstTouches, FindsTheDistributionThatGaveTheCounts) {
  for (const double k : {0.3, 1.0, 4.0})
    for (const double a : {0.2, 2.0, 20.0}) {
      const double half = asked(5000, a, k, 0.5), all = asked(5000, a, k, 1), frame = asked(5000, a, k, 10);
      const Estimate e = first_touches(half, all, 5000, 10);
      EXPECT_NEAR(e.value, frame, 1e-3 * frame) << k << " " << a;
      EXPECT_LE(e.low, e.value);
      EXPECT_GE(e.high, e.value);
      EXPECT_GE(e.low, all);
    }
}

TEST(FirstTouches, NeverExceedsTheLinesThatThereAre) {
  EXPECT_LE(first_touches(500, 1000, 1010, 100).high, 1010);
  EXPECT_EQ(first_touches(600, 1000, 1000, 10).value, 1000);
  EXPECT_EQ(first_touches(0, 0, 1000, 10).value, 0);
  const Estimate grows = first_touches(400, 800, 1000, 5);  // faster than lines of equal rates
  EXPECT_NEAR(grows.value, 1000 * (1 - std::pow(0.2, 5)), 1e-6);
}

TEST(FirstTouches, ASampleThatIsTheFrameIsItself) {
  EXPECT_NEAR(first_touches(300, 500, 4000, 1).value, 500, 1e-6);
}

}  // namespace
}  // namespace carousel::ringbus
