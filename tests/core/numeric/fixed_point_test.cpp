#include "core/numeric/fixed_point.h"

#include <limits>

#include <gtest/gtest.h>

#include "core/numeric/divisor.h"

namespace carousel {
namespace {

std::int64_t fixed(float value, std::uint64_t expected_saturations = 0) {
  std::uint64_t saturated = 0;
  const std::int64_t result = to_fixed_point(value, saturated);
  EXPECT_EQ(saturated, expected_saturations) << value;
  return result;
}

TEST(FixedPoint, RoundsToTheNearestStep) {
  EXPECT_EQ(fixed(0.0f), 0);
  EXPECT_EQ(fixed(-0.0f), 0);
  EXPECT_EQ(fixed(1.0f), std::int64_t{1} << 28);
  EXPECT_EQ(fixed(-1.5f), -(std::int64_t{3} << 27));
  EXPECT_EQ(fixed(0x1p-28f), 1);
  EXPECT_EQ(fixed(0x1p-29f), 1);
  EXPECT_EQ(fixed(-0x1p-29f), -1);
  EXPECT_EQ(fixed(0x1.fffp-30f), 0);
  EXPECT_EQ(fixed(std::numeric_limits<float>::denorm_min()), 0);
}

TEST(FixedPoint, SaturatesAndCounts) {
  EXPECT_EQ(fixed(0x1p20f), kFixedPointMax);
  EXPECT_EQ(fixed(0x1.000002p20f, 1), kFixedPointMax);
  EXPECT_EQ(fixed(-0x1p21f, 1), -kFixedPointMax);
  EXPECT_EQ(fixed(std::numeric_limits<float>::max(), 1), kFixedPointMax);
  EXPECT_EQ(fixed(std::numeric_limits<float>::infinity(), 1), kFixedPointMax);
  EXPECT_EQ(fixed(-std::numeric_limits<float>::infinity(), 1), -kFixedPointMax);
}

TEST(FixedPoint, NotANumberIsNothingButCounted) {
  EXPECT_EQ(fixed(std::numeric_limits<float>::quiet_NaN(), 1), 0);
  EXPECT_EQ(fixed(-std::numeric_limits<float>::quiet_NaN(), 1), 0);
}

TEST(FixedPoint, SumsAreClampedLikeTerms) {
  std::uint64_t saturated = 0;
  EXPECT_EQ(clamp_fixed_point(kFixedPointMax, saturated), kFixedPointMax);
  EXPECT_EQ(saturated, 0u);
  EXPECT_EQ(clamp_fixed_point(kFixedPointMax + 1, saturated), kFixedPointMax);
  EXPECT_EQ(clamp_fixed_point(-3 * kFixedPointMax, saturated), -kFixedPointMax);
  EXPECT_EQ(saturated, 2u);
}

TEST(FixedPoint, MeanIsRoundedOnce) {
  EXPECT_EQ(mean_of_fixed_point(3 * (std::int64_t{1} << 28), 4), 0.75f);
  EXPECT_EQ(mean_of_fixed_point(1, 1), 0x1p-28f);
}

TEST(Divisor, DividesAsTheOperatorsDo) {
  for (const std::uint64_t by : {1ull, 2ull, 3ull, 12ull, 64ull, 1000ull, 1ull << 40}) {
    const Divisor divisor(by);
    EXPECT_EQ(divisor.value(), by);
    for (const std::uint64_t n : {0ull, 1ull, 2ull, 11ull, 12ull, 13ull, 63ull, 64ull, 65ull, (1ull << 62) - 1}) {
      EXPECT_EQ(divisor.quotient(n), n / by) << n << " / " << by;
      EXPECT_EQ(divisor.remainder(n), n % by) << n << " % " << by;
      EXPECT_EQ(divisor.ceiling(n), n / by + (n % by > 0)) << n << " / " << by;
    }
  }
}

}  // namespace
}  // namespace carousel
