// The sphere test against 113-bit arithmetic, and the code of points on it.
#include "accel/structure/sphere.h"

#include <cmath>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "core/numeric/octahedral.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

using Quad = boost::multiprecision::cpp_bin_float_quad;

TEST(Sphere, IsMetWhereArithmeticOf113BitsSays) {
  Random random(run_seed());
  int hits = 0, near_misses = 0;
  for (int i = 0; i < 100000; ++i) {
    const float far = std::exp2(static_cast<float>(random.below(40)) - 10),
                radius = std::exp2(static_cast<float>(random.below(20)) - 10);
    const Vec3 centre = random.in_box(Vec3{-1}, Vec3{1}) * far;
    const Vec3 origin = centre + random.in_box(Vec3{-1}, Vec3{1}) * far;
    // Half are aimed at the rim.
    const Vec3 side = glm::normalize(random.in_box(Vec3{-1}, Vec3{1}) + Vec3{1e-3f});
    const Vec3 d = (centre + side * radius * (i % 2 ? 1.0f : random.uniform())) - origin;
    Quad a = 0, b = 0, c = -Quad(radius) * radius;
    for (int axis = 0; axis < 3; ++axis) {
      const Quad f = Quad(origin[axis]) - centre[axis];
      a += Quad(d[axis]) * d[axis];
      b += f * d[axis];
      c += f * f;
    }
    const Quad discriminant = b * b - a * c;
    // How far the line is from the rim, in radii: what double cannot tell, nobody minds.
    const Quad rim = a > 0 ? discriminant / (a * radius * radius) : Quad(0);
    SphereCrossing crossing;
    const bool met = cross_sphere(origin, d, centre, radius, crossing);
    const double reach = glm::length(DVec3(origin) - DVec3(centre)) / radius;  // its square weighs on the rounding
    const double unsure = 0x1p-48 * (1 + reach * reach);
    if (abs(rim) < unsure) {
      ++near_misses;
      continue;
    }
    ASSERT_EQ(met, rim > 0) << "case " << i << " seed " << run_seed();
    if (!met) continue;
    ++hits;
    for (int k = 0; k < 2; ++k) {
      const Quad t = (-b + (k == 0 ? -1 : 1) * sqrt(discriminant)) / a;
      const double size = std::fabs(double(b / a)) + double(sqrt(discriminant) / a);
      const double tolerance = unsure * double(radius / sqrt(a)) / std::sqrt(double(rim)) + 0x1p-48 * size;
      ASSERT_NEAR(crossing.t[k], double(t), tolerance) << "case " << i << " seed " << run_seed();
      ASSERT_NEAR(glm::length(crossing.normal[k]), 1.0, 1e-14);
    }
    ASSERT_LE(crossing.t[0], crossing.t[1]);
  }
  EXPECT_GT(hits, 40000);
  EXPECT_LT(near_misses, 50000);
}

TEST(Sphere, IsNotMetByWhatIsNoRayOrNoSphere) {
  SphereCrossing crossing;
  const float nan = std::nanf("");
  EXPECT_TRUE(cross_sphere({0, 0, 0}, {0, 0, 1}, {0, 0, 5}, 1, crossing));
  EXPECT_FALSE(cross_sphere({0, 0, 0}, {0, 0, 0}, {0, 0, 5}, 9, crossing));
  EXPECT_FALSE(cross_sphere({0, 0, 0}, {0, 0, 1}, {0, 0, 5}, 0, crossing));
  EXPECT_FALSE(cross_sphere({nan, 0, 0}, {0, 0, 1}, {0, 0, 5}, 1, crossing));
  EXPECT_FALSE(cross_sphere({0, 0, 0}, {0, nan, 1}, {0, 0, 5}, 1, crossing));
  EXPECT_FALSE(cross_sphere({0, 0, 0}, {0, 0, 1}, {0, 0, 5}, nan, crossing));
}

TEST(Sphere, FillsItsBox) {
  Random random(run_seed());
  for (int i = 0; i < 10000; ++i) {
    const Vec3 c = random.in_box(Vec3{-100}, Vec3{100});
    const float r = std::exp2(random.uniform(-20, 20));
    const Aabb box = sphere_box(c, r);
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_LE(double{box.lo[axis]}, double{c[axis]} - r);
      ASSERT_GE(double{box.hi[axis]}, double{c[axis]} + r);
      ASSERT_GT(double{std::nextafter(box.lo[axis], 1e30f)}, double{c[axis]} - r);
      ASSERT_LT(double{std::nextafter(box.hi[axis], -1e30f)}, double{c[axis]} + r);
    }
  }
}

TEST(Octahedral, FindsThePointAgain) {
  Random random(run_seed());
  for (int i = 0; i < 20000; ++i) {
    DVec3 n(random.in_box(Vec3{-1}, Vec3{1}));
    if (i % 8 == 0) n[static_cast<int>(random.below(3))] = 0;
    if (i % 16 == 0) n = {0, 0, random.below(2) == 0 ? -1.0 : 1.0};
    if (glm::length(n) < 1e-3) continue;
    n = glm::normalize(n);
    const Vec2 uv = octahedral(n);
    ASSERT_TRUE(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1);
    ASSERT_LT(glm::length(from_octahedral(uv.x, uv.y) - n), 4e-7) << "case " << i;
  }
}

}  // namespace
}  // namespace carousel::accel
