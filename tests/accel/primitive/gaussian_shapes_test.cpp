// Where the response of a Gaussian is greatest along a ray, in closed form and by search.
#include "accel/structure/gaussian_shapes.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "scene/builtin/builtin.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

scene::GaussianCloud cloud_of(const scene::Gaussian& one) {
  scene::GaussianCloud cloud;
  cloud.shapes = {one};
  return cloud;
}

Hit shape_at(float t) {
  return {t, 0, 0, 0, 0};
}

TEST(GaussianShapes, RoundOneIsMetWhereTheRayIsNearestToItsMean) {
  scene::Gaussian one;
  one.mean = {0, 1, 5};
  one.spread = Mat3(0.5f);
  one.opacity = 0.5f;
  const GaussianShapes shapes(cloud_of(one));  // ends three standard deviations away
  Hit hit;
  ASSERT_TRUE(shapes.respond({Vec3(0), 0, {0, 0, 2}, kInfinity}, 0, shape_at(0), hit));
  EXPECT_EQ(hit.t, 2.5f);
  EXPECT_EQ(hit.u, 4.0f);  // two standard deviations off, squared
  EXPECT_NEAR(shapes.alpha(hit), 0.5 * std::exp(-2.0), 1e-7);
  EXPECT_FALSE(shapes.respond({{0, -0.51f, 0}, 0, {0, 0, 1}, kInfinity}, 0, shape_at(0), hit));
  EXPECT_TRUE(shapes.respond({{0, -0.49f, 0}, 0, {0, 0, 1}, kInfinity}, 0, shape_at(0), hit));
}

TEST(GaussianShapes, IsMetWithinTheRayAndBehindTheFrontOfItsShapeAlone) {
  scene::Gaussian one;
  one.mean = {0, 0, 5};
  const GaussianShapes shapes(cloud_of(one));
  const auto meets = [&](float tmin, float tmax, float shape) {
    Hit hit;
    return shapes.respond({Vec3(0), tmin, {0, 0, 1}, tmax}, tmin, shape_at(shape), hit);
  };
  EXPECT_TRUE(meets(0, kInfinity, 2));
  EXPECT_TRUE(meets(5, 5, 5));
  EXPECT_FALSE(meets(0, 4.99f, 2));
  EXPECT_FALSE(meets(5.01f, kInfinity, 5.01f));
  EXPECT_FALSE(meets(0, kInfinity, 8));  // the way out of the shape
}

TEST(GaussianShapes, OpaqueOnesLeaveAHundredthOfTheLight) {
  const GaussianShapes shapes(cloud_of({}));
  EXPECT_EQ(shapes.alpha(shape_at(0)), 0.99f);
}

// A node's turn of its harmonics is the way back of the direction; neither length matters.
TEST(GaussianShapes, ColourTurnsWithItsFrame) {
  scene::Scene scene = scene::make_gaussians(30, 5, 3);
  const GaussianShapes still(scene.gaussians);
  EXPECT_EQ(still.color_terms(), 15u);
  const DMat3 turn(DVec3(0, 2, 0), DVec3(0, 0, 2), DVec3(2, 0, 0));  // x to y to z, twice as large
  scene.gaussians.frames = {DMat3(1.0), glm::inverse(turn)};
  for (scene::Gaussian& one : scene.gaussians.shapes) one.frame = 1;
  const GaussianShapes turned(scene.gaussians);
  EXPECT_EQ(turned.color_terms(), 18u);
  EXPECT_EQ(turned.bytes_in_instance(), still.bytes_in_instance() + 36);
  bool differs = false;
  for (std::uint32_t i = 0; i < 30; ++i) {
    const Hit hit{1, 0, 0, i, 0};
    const Vec3 a = still.color(hit, {0.3f, -0.5f, 0.8f}), b = turned.color(hit, {0.8f * 3, 0.3f * 3, -0.5f * 3});
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-6f);
    differs |= a != still.color(hit, {0.8f, 0.3f, -0.5f});
    EXPECT_GE(std::min({a.x, a.y, a.z}), 0.0f);
  }
  EXPECT_TRUE(differs);
}

// The response at the hit is the greatest of many along the ray, computed with the inverse of the covariance.
TEST(GaussianShapes, NoPlaceOfTheRayRespondsMore) {
  const scene::Scene scene = scene::make_gaussians(40, 9);
  const GaussianShapes shapes(scene.gaussians);
  std::uint32_t met = 0;
  for (std::uint32_t i = 0; i < scene.gaussians.shapes.size(); ++i) {
    const scene::Gaussian& one = scene.gaussians.shapes[i];
    const DMat3 spread(one.spread), precision = glm::inverse(spread * glm::transpose(spread));
    const DVec3 origin(3, 2, 4), to = DVec3(one.mean) + DMat3(one.spread) * DVec3(0.3, -0.4, 0.2);
    const Ray ray{Vec3(origin), 0, Vec3(to - origin), kInfinity};
    const auto distance = [&](double t) {
      const DVec3 off = DVec3(ray.origin) + t * DVec3(ray.direction) - DVec3(one.mean);
      return glm::dot(off, precision * off);
    };
    Hit hit;
    ASSERT_TRUE(shapes.respond(ray, 0, {0, 0, 0, i, 0}, hit));
    ++met;
    EXPECT_NEAR(hit.u, distance(double{hit.t}), 1e-4);
    for (double t = 0.5; t < 1.5; t += 1e-3) EXPECT_GE(distance(t), double{hit.u} - 1e-5) << i << " " << t;
  }
  EXPECT_EQ(met, 40u);
}

}  // namespace
}  // namespace carousel::accel
