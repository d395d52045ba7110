// The exact level against big integers: random and adversarial cases, bit by bit.
#include "accel/exact/exact_triangle.h"

#include <cmath>
#include <iostream>

#include <gtest/gtest.h>

#include "accel/certificate/triangle_oracle.h"
#include "tests/accel/exact/adversarial_cases.h"
#include "tests/accel/primitive/adversarial_triangles.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

class ExactTriangle : public testing::TestWithParam<int> {};

TEST_P(ExactTriangle, DecidesAndRoundsAsBigIntegersDo) {
  const auto kind = static_cast<TriangleCaseKind>(GetParam());
  Random random(1000 * std::uint64_t{run_seed()} + static_cast<std::uint64_t>(GetParam()));
  int hits = 0, misses = 0, wrong = 0;
  const int cases = adversarial_cases() / kTriangleCaseKinds;
  for (int i = 0; i < cases; ++i) {
    const TriangleCase c = triangle_case(kind, random);
    const TriangleOracle oracle(c.ray, c.corners);
    NearestCrossing crossing;
    const bool hit = exact_triangle(c.ray, c.corners, crossing);
    (hit ? hits : misses) += 1;
    if (hit == oracle.hit() && (!hit || (oracle.t_is_nearest(crossing.t) && oracle.u_is_nearest(crossing.u) &&
                                         oracle.v_is_nearest(crossing.v))))
      continue;
    if (++wrong <= 3)
      ADD_FAILURE() << "CAROUSEL_SEED=" << run_seed() << " case " << i << ": " << text(c)
                    << (hit ? " hit at " : " missed ") << std::hexfloat << crossing.t << " " << crossing.u << " "
                    << crossing.v << ", exactly " << (oracle.hit() ? "a hit" : "a miss");
  }
  std::cout << cases << " cases, " << hits << " hits, " << misses << " misses\n";
  EXPECT_EQ(wrong, 0);
  EXPECT_TRUE(kind == TriangleCaseKind::kDegenerate ? hits == 0 : hits > cases / 500) << hits;
  EXPECT_GT(misses, cases / 500);
}

INSTANTIATE_TEST_SUITE_P(Cases, ExactTriangle, testing::Range(0, kTriangleCaseKinds), [](const auto& kind) {
  return std::string(kTriangleCaseNames[static_cast<std::size_t>(kind.param)]);
});

// An edge of two triangles belongs to both, and nothing gets through between.
TEST(ExactTriangleEdges, SharedEdgeIsHitInBoth) {
  Random random(71);
  int both = 0;
  for (int i = 0; i < 30000; ++i) {
    const auto grid = [&] {
      return Vec3{static_cast<float>(random.below(17)) - 8, static_cast<float>(random.below(17)) - 8,
                  static_cast<float>(random.below(17)) - 8};
    };
    const Vec3 a = grid(), b = grid(), left = grid(), right = grid(), from = grid();
    Ray ray;
    ray.origin = from;
    ray.direction = 0.5f * (a + b) - from;  // exact on this grid
    NearestCrossing one, other;
    const bool hit = exact_triangle(ray, {a, b, left}, one);
    if (TriangleOracle(ray, {b, a, right}).hit()) {
      ASSERT_TRUE(exact_triangle(ray, {b, a, right}, other));
      if (hit) {
        ASSERT_EQ(one.t, other.t);
        ASSERT_EQ(one.t, 1);
        ++both;
      }
    }
  }
  EXPECT_GT(both, 20000);
}

TEST(ExactTriangleEdges, NothingIsHitWithoutNumbers) {
  const std::array<Vec3, 3> p{Vec3{-1, -1, 0}, Vec3{1, -1, 0}, Vec3{0, 1, 0}};
  Ray ray;
  ray.origin = {0, 0, -1};
  NearestCrossing crossing;
  ASSERT_TRUE(exact_triangle(ray, p, crossing));
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      Ray r = ray;
      r.origin[axis] = bad;
      EXPECT_FALSE(exact_triangle(r, p, crossing));
      r = ray;
      r.direction[axis] = bad;
      EXPECT_FALSE(exact_triangle(r, p, crossing));
      for (std::size_t k = 0; k < 3; ++k) {
        std::array<Vec3, 3> q = p;
        q[k][axis] = bad;
        EXPECT_FALSE(exact_triangle(ray, q, crossing));
      }
    }
  }
  ray.direction = Vec3{0};
  EXPECT_FALSE(exact_triangle(ray, p, crossing));
}

}  // namespace
}  // namespace carousel::accel
