#include "ringbus/verdict/cycle_noise.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace carousel::ringbus {
namespace {

TEST(CycleNoise, IsThatOfStudentsDistribution) {
  // Deviation 2, mean 100, two degrees of freedom: 4.302653 from any table of t.
  const auto whole = cycle_noise({100, 102, 98}, true);
  ASSERT_TRUE(whole);
  EXPECT_NEAR(whole->fraction, 4.302653 * std::sqrt(2.0) * 2 / 100, 1e-6);
  EXPECT_EQ(whole->seeds, 2u);
  EXPECT_TRUE(whole->whole);
  EXPECT_FALSE(cycle_noise({100, 102, 98}, false)->whole);
  EXPECT_FALSE(cycle_noise({100, 102}, true));
}

// 95 of 100 further draws lie within the interval around a draw that the noise was not found with.
TEST(CycleNoise, HoldsFurtherDraws) {
  std::mt19937 random(7);
  std::normal_distribution<double> draw(1000, 30);
  int within = 0;
  constexpr int kTrials = 4000;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> some;
    for (int i = 0; i < 5; ++i) some.push_back(draw(random));
    within += std::abs(draw(random) - draw(random)) <= 1000 * cycle_noise(some, true)->fraction;
  }
  EXPECT_NEAR(double(within) / kTrials, 0.95, 0.02);
}

}  // namespace
}  // namespace carousel::ringbus
