// Functions that are the same on every host, against the C library's in long double.
#include "core/numeric/trigonometry.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/numeric/exponential.h"
#include "tests/support/random_runs.h"

namespace carousel {
namespace {

double relative(double value, long double wanted) {
  return static_cast<double>(std::fabs((value - wanted) / wanted));
}

TEST(AngleFunctions, IsThatOfLongDouble) {
  std::mt19937_64 random(run_seed());
  const auto within = [&](double from, double to) {
    return from + (to - from) * 0x1p-53 * static_cast<double>(random() >> 11);
  };
  for (int i = 0; i < scaled(100000, 10000); ++i)
    for (const double most : {1.0, 100.0, 2e7}) {
      const double angle = within(-most, most);
      const SinCos64 of = sin_cos(angle);
      ASSERT_NEAR(of.sin, static_cast<double>(std::sin(static_cast<long double>(angle))), 4e-16) << angle;
      ASSERT_NEAR(of.cos, static_cast<double>(std::cos(static_cast<long double>(angle))), 4e-16) << angle;
    }
  EXPECT_EQ(sin_float(0), 0.0f);
  EXPECT_EQ(cos_float(0), 1.0f);
  EXPECT_TRUE(std::isnan(sin_cos(std::numeric_limits<double>::infinity()).sin));
  EXPECT_LE(std::fabs(sin_cos(1e300).cos), 1.0);
  EXPECT_NEAR(tan_double(0.7), std::tan(0.7), 1e-15);
}

TEST(PreciseExponential, IsThatOfLongDouble) {
  std::mt19937_64 random(run_seed());
  const auto within = [&](double from, double to) {
    return from + (to - from) * 0x1p-53 * static_cast<double>(random() >> 11);
  };
  for (int i = 0; i < scaled(100000, 10000); ++i) {
    const double x = within(-100, 100), base = within(1e-6, 1e3), power = within(-3, 3);
    ASSERT_LT(relative(exp_precise(x), std::exp(static_cast<long double>(x))), 3e-14) << x;
    ASSERT_NEAR(log_precise(base), static_cast<double>(std::log(static_cast<long double>(base))), 1e-14) << base;
    ASSERT_LT(
        relative(pow_precise(base, power), std::pow(static_cast<long double>(base), static_cast<long double>(power))),
        3e-14)
        << base << " " << power;
  }
  EXPECT_EQ(exp_precise(0), 1.0);
  EXPECT_EQ(exp_precise(-1e4), 0.0);
  EXPECT_TRUE(std::isinf(exp_precise(1e4)));
  EXPECT_EQ(pow_precise(0, 2.4), 0.0);
}

}  // namespace
}  // namespace carousel
