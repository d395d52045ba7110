#include "shading/surface/spawn_point.h"

#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "core/numeric/condition.h"
#include "tests/shading/path/small_scenes.h"

namespace carousel::shading {
namespace {

// 113-bit floats: exact enough that their own rounding never decides a side here.
using Quad = __float128;
struct QVec {
  Quad x, y, z;
};
QVec operator-(const QVec& a, const QVec& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
QVec cross(const QVec& a, const QVec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Quad dot(const QVec& a, const QVec& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
QVec to_quad(const Vec3& v) {
  return {v.x, v.y, v.z};
}
QVec transform(const scene::Affine& m, const Vec3& p) {
  auto row = [&](int r) -> Quad {
    return Quad(m.linear[0][r]) * p.x + Quad(m.linear[1][r]) * p.y + Quad(m.linear[2][r]) * p.z +
           Quad(m.translation[r]);
  };
  return {row(0), row(1), row(2)};
}

/// Distance of `p` from the plane of the placed triangle, positive on its front side.
double plane_side(const scene::Scene& scene, const Vec3& p) {
  const scene::Affine& m = scene.instances[0].world_from_model;
  const auto& v = scene.meshes[0].positions;
  const QVec a = transform(m, v[0]), b = transform(m, v[1]), c = transform(m, v[2]);
  const QVec n = cross(b - a, c - a);
  const Quad determinant = dot(to_quad(m.linear[0]), cross(to_quad(m.linear[1]), to_quad(m.linear[2])));
  const double length = std::sqrt(double(dot(n, n)));
  return double(dot(n, to_quad(p) - a)) / (determinant < 0 ? -length : length);
}

/// The model-space side for a tracer that computes R^-1 (o - T) in float, or in double if R is nearly singular. It must
/// not flip.
double traced_side(const scene::Scene& scene, const Vec3& p) {
  const scene::Affine& m = scene.instances[0].world_from_model;
  const DMat3 inverse = glm::inverse(DMat3(m.linear));
  const Vec3 o = skeel_condition(m.linear) > kConditionForFloat ? Vec3(inverse * (DVec3(p) - DVec3(m.translation)))
                                                                : Mat3(inverse) * (p - m.translation);
  const auto& v = scene.meshes[0].positions;
  const QVec a = to_quad(v[0]);
  return double(dot(cross(to_quad(v[1]) - a, to_quad(v[2]) - a), to_quad(o) - a));
}

class Cases {
 public:
  float uniform(float lo, float hi) { return std::uniform_real_distribution<float>(lo, hi)(random_); }
  Vec3 vector(float r) { return {uniform(-r, r), uniform(-r, r), uniform(-r, r)}; }
  scene::Scene triangle(float size, float offset, const scene::Affine& placement) {
    scene::Scene scene = empty_scene();
    add_material(scene, matte(Vec3{1}));
    const Vec3 base = vector(offset);
    add_mesh(scene, {base + vector(size), base + vector(size), base + vector(size)}, {0, 1, 2}, 0, placement);
    return scene;
  }
  /// Barycentrics of a point inside, or on an edge or vertex.
  Vec2 point() {
    float u = uniform(0, 1), v = uniform(0, 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    switch (std::uniform_int_distribution<int>(0, 5)(random_)) {
      case 0:
        return {u, 0};
      case 1:
        return {0, v};
      case 2:
        return {0, 0};
      default:
        return {u, v};
    }
  }

 private:
  std::mt19937 random_{20240607};
};

void expect_right_sides(const scene::Scene& scene, const Vec2& b) {
  const TriangleGeometry g = triangle_geometry(scene, 0, 0, b.x, b.y);
  if (g.area == 0.0) return;  // vertices rounded onto a line; there is no plane
  const Vec3 front = spawn_point(g, Side::kFront, SpawnOffset::kBound);
  const Vec3 back = spawn_point(g, Side::kBack, SpawnOffset::kBound);
  ASSERT_GT(plane_side(scene, front), 0.0);
  ASSERT_LT(plane_side(scene, back), 0.0);
  ASSERT_GT(traced_side(scene, front), 0.0);
  ASSERT_LT(traced_side(scene, back), 0.0);
}

// Others reported this kind of fault: mitsuba3 1871, trimesh 2524.
TEST(SpawnPoint, IsOnItsSideOfRandomTriangles) {
  Cases cases;
  for (int i = 0; i < 20000; ++i) {
    const float size = std::pow(10.0f, cases.uniform(-3, 3)), offset = std::pow(10.0f, cases.uniform(-3, 5));
    expect_right_sides(cases.triangle(size, offset, {}), cases.point());
  }
}

TEST(SpawnPoint, IsOnItsSideOfRandomInstances) {
  Cases cases;
  for (int i = 0; i < 20000; ++i) {
    scene::Affine placement{Mat3(cases.vector(1), cases.vector(1), cases.vector(1)),
                            cases.vector(std::pow(10.0f, cases.uniform(-2, 6)))};
    placement.linear *= std::pow(10.0f, cases.uniform(-2, 2));
    expect_right_sides(cases.triangle(1, std::pow(10.0f, cases.uniform(-2, 2)), placement), cases.point());
  }
}

// Others reported this kind of fault: mitsuba3 1871, trimesh 2524.
TEST(SpawnPoint, IsOnItsSideFarAway) {
  Cases cases;
  for (const float away : {1e6f, 1e7f})
    for (int i = 0; i < 2000; ++i) {
      const scene::Affine placement{Mat3(1.0f), {away, cases.uniform(-away, away), -away}};
      expect_right_sides(cases.triangle(1, 0, placement), cases.point());
    }
}

TEST(SpawnPoint, StaysWithinAFewUlps) {
  Cases cases;
  for (int i = 0; i < 2000; ++i) {
    const scene::Scene scene = cases.triangle(1, 100, {});
    const Vec2 b = cases.point();
    const TriangleGeometry g = triangle_geometry(scene, 0, 0, b.x, b.y);
    const Vec3 p = spawn_point(g, Side::kFront, SpawnOffset::kBound);
    const double magnitude = glm::length(g.position);
    EXPECT_LT(glm::length(DVec3(p) - g.position), 20 * 0x1p-23 * magnitude);
  }
}

TEST(SpawnPoint, OfASingularInstanceLeavesItsWorldSpaceTriangle) {
  Cases cases;
  for (int i = 0; i < 2000; ++i) {
    const scene::Affine flat{Mat3(1, 0, 0, 0, 0, 0, 0, 0, 1), cases.vector(1000)};
    const scene::Scene scene = cases.triangle(1, 10, flat);
    const Vec2 b = cases.point();
    const TriangleGeometry g = triangle_geometry(scene, 0, 0, b.x, b.y);
    EXPECT_GT(g.area, 0.0);
    const Vec3 front = spawn_point(g, Side::kFront, SpawnOffset::kBound);
    const Vec3 back = spawn_point(g, Side::kBack, SpawnOffset::kBound);
    EXPECT_NE(front.y > flat.translation.y, back.y > flat.translation.y);
    EXPECT_NE(front.y, flat.translation.y);
    EXPECT_NE(back.y, flat.translation.y);
  }
}

// Others reported this kind of fault: FBX2glTF 31, GLTFKit2 26.
TEST(SpawnPoint, SidesFollowTheWindingThroughMirroredInstances) {
  scene::Scene scene = empty_scene();
  add_material(scene, matte(Vec3{1}));
  // glTF flips the winding of a mirrored instance: its front is the mirror image of the front.
  add_mesh(scene, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2}, 0, {Mat3(-1, 0, 0, 0, 1, 0, 0, 0, 1), Vec3{0}});
  const TriangleGeometry g = triangle_geometry(scene, 0, 0, 0.25f, 0.25f);
  EXPECT_EQ(g.normal, DVec3(0, 0, 1));
  EXPECT_TRUE(g.mirrored);
  EXPECT_DOUBLE_EQ(g.area, 0.5);
  EXPECT_EQ(g.position, DVec3(-0.25, 0.25, 0));
}

TEST(SpawnPoint, OtherPoliciesMoveByTheirOwnAmounts) {
  scene::Scene scene = empty_scene();
  add_material(scene, matte(Vec3{1}));
  add_mesh(scene, {{1, 0, 2}, {3, 0, 2}, {1, 4, 2}}, {0, 1, 2}, 0);
  const TriangleGeometry g = triangle_geometry(scene, 0, 0, 0.25f, 0.25f);
  EXPECT_EQ(spawn_point(g, Side::kFront, SpawnOffset::kEpsilon).z, 2.0f + 1e-4f);
  EXPECT_EQ(spawn_point(g, Side::kBack, SpawnOffset::kUlp).z, 2.0f - 256 * 0x1p-23f);
}

}  // namespace
}  // namespace carousel::shading
