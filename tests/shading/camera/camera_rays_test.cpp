#include "shading/camera/camera_rays.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace carousel::shading {
namespace {

const CameraDraw kCentre{{0.5f, 0.5f}, {0.5f, 0.5f}};

TEST(CameraRays, RowZeroIsTheTopAndColumnZeroTheLeft) {
  const CameraRays rays(scene::Camera{}, {}, 100, 100);
  const Ray top_left = rays.ray(0, 0, kCentre), bottom_right = rays.ray(99, 99, kCentre);
  EXPECT_LT(top_left.direction.x, 0.0f);
  EXPECT_GT(top_left.direction.y, 0.0f);
  EXPECT_LT(top_left.direction.z, 0.0f);
  EXPECT_GT(bottom_right.direction.x, 0.0f);
  EXPECT_LT(bottom_right.direction.y, 0.0f);
}

TEST(CameraRays, PerspectiveCoversTheVerticalFieldOfView) {
  scene::Camera camera;
  camera.yfov = 1.0f;
  const CameraRays rays(camera, {}, 300, 100);
  const Ray up = rays.ray(150, 0, {{0, 0}, {0, 0}}), right = rays.ray(299, 50, {{1, 0}, {0, 0}});
  EXPECT_NEAR(up.direction.y / -up.direction.z, std::tan(0.5f), 1e-6f);
  EXPECT_NEAR(right.direction.x / -right.direction.z, 3 * std::tan(0.5f), 1e-5f);
  EXPECT_NEAR(glm::length(right.direction), 1.0f, 1e-6f);
}

TEST(CameraRays, NearPlaneIsMeasuredAlongTheAxis) {
  scene::Camera camera;
  camera.znear = 0.5f;
  const CameraRays rays(camera, {}, 100, 100);
  const Ray corner = rays.ray(0, 0, kCentre);
  EXPECT_NEAR(corner.tmin * -corner.direction.z, 0.5f, 1e-6f);
}

// Others reported this kind of fault: three.js 24800, glTF 1663.
TEST(CameraRays, OrthographicRaysAreParallelAndKeepTheWindow) {
  scene::Camera camera;
  camera.projection = scene::Camera::Projection::kOrthographic;
  camera.xmag = 4;
  camera.ymag = 1;
  const CameraRays rays(camera, {}, 100, 50);  // a window of 8 x 2 in an image of 2 : 1
  const Ray a = rays.ray(0, 0, {{0, 0}, {0, 0}}), b = rays.ray(99, 49, {{1, 1}, {0, 0}});
  EXPECT_EQ(a.direction, b.direction);
  EXPECT_NEAR(a.origin.x, -4, 1e-5f);
  EXPECT_NEAR(b.origin.x, 4, 1e-5f);
  EXPECT_NEAR(a.origin.y, 2, 1e-5f);
}

TEST(CameraRays, LensRaysMeetInTheFocalPlane) {
  CameraConfig lens;
  lens.aperture = 0.5f;
  lens.focus_distance = 3;
  const CameraRays rays(scene::Camera{}, lens, 64, 64);
  const Ray a = rays.ray(10, 20, {{0.5f, 0.5f}, {0.1f, 0.9f}}), b = rays.ray(10, 20, {{0.5f, 0.5f}, {0.8f, 0.3f}});
  EXPECT_NE(a.origin, b.origin);
  EXPECT_LE(glm::length(a.origin), 0.25f + 1e-6f);
  const Vec3 pa = a.origin + a.direction * (-3.0f / a.direction.z);
  const Vec3 pb = b.origin + b.direction * (-3.0f / b.direction.z);
  EXPECT_NEAR(glm::length(pa - pb), 0.0f, 1e-5f);
}

}  // namespace
}  // namespace carousel::shading
