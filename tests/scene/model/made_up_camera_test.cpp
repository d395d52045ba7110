// The view of a file that has no camera.
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "scene/builtin/builtin.h"
#include "scene/builtin/mesh_shapes.h"
#include "scene/model/fitted_camera.h"
#include "scene/model/floor_plan.h"
#include "scene/place_gaussians.h"

namespace carousel::scene {
namespace {

/// The part of the frame that the model takes in x and y: 1 if it touches both edges.
Vec2 filled(const Scene& scene, const Camera& camera, float aspect) {
  Vec2 lo(1e30f), hi(-1e30f);
  const float high = std::tan(0.5f * camera.yfov);
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh.value];
    for (const std::uint32_t i : mesh.indices) {
      const Vec3 p = instance.world_from_model.linear * mesh.positions[i] + instance.world_from_model.translation;
      const Vec3 way = p - camera.position;
      const float depth = -glm::dot(way, camera.back);
      EXPECT_GT(depth, 0);
      const Vec2 at(glm::dot(way, camera.right) / (depth * high * aspect), glm::dot(way, camera.up) / (depth * high));
      lo = glm::min(lo, at);
      hi = glm::max(hi, at);
    }
  }
  EXPECT_GE(lo.x, -1);
  EXPECT_GE(lo.y, -1);
  EXPECT_LE(hi.x, 1);
  EXPECT_LE(hi.y, 1);
  return 0.5f * (hi - lo);
}

Scene ball(const Affine& placement = {}) {
  Scene scene;
  scene.materials.emplace_back();
  add_icosphere(scene.meshes.emplace_back(), Vec3(1, 2, 3), 2, 2, MaterialId(0));
  scene.instances.push_back({MeshId(0), placement});
  return scene;
}

TEST(FittedCamera, TheModelTouchesTheFrame) {
  Affine flat{Mat3(1.0f), {100, -30, 5}};
  flat.linear[1] *= 0.05f;
  Affine tall{Mat3(1.0f), {0, 0, 0}};
  tall.linear[1] *= 30.0f;
  for (const Affine& placement : {Affine{}, flat, tall}) {
    const Scene scene = ball(placement);
    for (const float aspect : {0.4f, 1.0f, 2.5f}) {
      const Vec2 part = filled(scene, fitted_camera(scene, aspect), aspect);
      EXPECT_GT(std::max(part.x, part.y), 0.93f) << aspect;
    }
  }
}

TEST(FittedCamera, VerticesWithoutATriangleDoNotCount) {
  Scene scene = ball();
  const Camera alone = fitted_camera(scene, 1);
  scene.meshes[0].positions.emplace_back(1000, 0, 0);
  const Camera other = fitted_camera(scene, 1);
  EXPECT_LT(glm::length(other.position - alone.position), 1e-2f);
}

TEST(FittedCamera, SpheresAreFittedAsSpheres) {
  Scene scene;
  scene.materials.emplace_back();
  scene.meshes.emplace_back().spheres.push_back({Vec3(0), 2, MaterialId(0)});
  scene.instances.push_back({MeshId(0), {}});
  const Camera camera = fitted_camera(scene, 1);
  // The cone around a ball of radius r at distance d has the half angle asin(r/d); 4 % of the frame stay free.
  const float d = glm::length(camera.position);
  EXPECT_NEAR(std::tan(std::asin(2 / d)), std::tan(0.5f * camera.yfov) / 1.04f, 1e-3f);
}

/// A box of 8 by 3 by 6 whose walls face inward, or outward.
Scene room(bool inward, bool roof = true) {
  Scene scene;
  scene.materials.emplace_back();
  Mesh& mesh = scene.meshes.emplace_back();
  for (int i = 0; i < 8; ++i) mesh.positions.emplace_back(i & 1 ? 8 : 0, i & 2 ? 3 : 0, i & 4 ? 6 : 0);
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {  // seen from outside
    if (inward) std::swap(b, d);
    mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
  };
  quad(0, 4, 6, 2), quad(1, 3, 7, 5), quad(0, 2, 3, 1), quad(4, 5, 7, 6), quad(0, 1, 5, 4);
  if (roof) quad(2, 6, 7, 3);
  mesh.triangle_materials.assign(mesh.triangle_count(), MaterialId(0));
  scene.instances.push_back({MeshId(0), {}});
  return scene;
}

TEST(InsideCamera, StandsInARoomAndLooksAlongIt) {
  for (const bool roof : {true, false}) {
    const auto camera = inside_camera(room(true, roof));
    ASSERT_TRUE(camera);
    const Vec3 p = camera->position;
    EXPECT_TRUE(p.x > 0 && p.x < 8 && p.z > 0 && p.z < 6);
    EXPECT_NEAR(p.y, 1.2f, 1e-5f);
    EXPECT_NEAR(camera->back.y, 0, 1e-6f);
    // At least as much room ahead as the longer side of the room has.
    float ahead = 0;
    while (p.x - ahead * camera->back.x > 0 && p.x - ahead * camera->back.x < 8 && p.z - ahead * camera->back.z > 0 &&
           p.z - ahead * camera->back.z < 6)
      ahead += 0.01f;
    EXPECT_GT(ahead, 7);
  }
}

TEST(InsideCamera, SmallThingsAreSeenFromOutside) {
  Scene scene = room(true);
  scene.instances[0].world_from_model.linear *= 0.4f;
  EXPECT_FALSE(inside_camera(scene)) << "a box turned inside out, not a room";
}

TEST(InsideCamera, SolidThingsAreSeenFromOutside) {
  EXPECT_FALSE(inside_camera(room(false)));
  EXPECT_FALSE(inside_camera(ball()));
  EXPECT_FALSE(inside_camera(Scene{}));
}

// Two boxes, one in the other: walls that are seen from both sides.
TEST(InsideCamera, WallsMayHaveAnOutside) {
  Scene scene = room(true);
  const Scene shell = room(false);
  scene.meshes.push_back(shell.meshes[0]);
  scene.instances.push_back({MeshId(1), {Mat3(1.1f), {-0.4f, -0.1f, -0.3f}}});
  EXPECT_TRUE(inside_camera(scene));
  for (Instance& instance : scene.instances) {
    instance.world_from_model.linear *= 0.3f;
    instance.world_from_model.translation *= 0.3f;
  }
  EXPECT_FALSE(inside_camera(scene)) << "a box of 2 m is no room";
}

TEST(InsideCamera, MirroredWallsFaceTheOtherWay) {
  Scene scene = room(false);
  scene.instances[0].world_from_model.linear[0].x = -1;
  EXPECT_FALSE(inside_camera(scene)) << "glTF: a mirrored instance turns its triangles, and stays solid";
  scene = room(true);
  scene.instances[0].world_from_model.linear[2].z = -1;
  EXPECT_TRUE(inside_camera(scene));
}

// Triangles reach farther than ellipsoids, and both show the same picture.
TEST(MadeUpCamera, IsTheSameForBothShapesOfGaussians) {
  using Geometry = GaussiansConfig::Geometry;
  std::vector<Camera> cameras;
  for (const Geometry geometry : {Geometry::kEllipsoids, Geometry::kTriangles}) {
    Scene scene = make_gaussians(50, 1);
    GaussiansConfig config;
    config.geometry = geometry;
    place_gaussians(scene, config, "cloud");
    make_up_camera(scene, 1.5f);
    cameras.push_back(scene.cameras[0]);
  }
  EXPECT_EQ(cameras[0].name, "fitted");
  EXPECT_EQ(cameras[0].position, cameras[1].position);
}

TEST(MadeUpCamera, SaysThatItStandsInside) {
  Scene scene = room(true);
  scene.cameras.emplace_back();
  make_up_camera(scene, 1);
  EXPECT_TRUE(scene.added.inside);
  EXPECT_EQ(scene.cameras[0].name, "inside");
  scene = room(false);
  scene.cameras.emplace_back();
  make_up_camera(scene, 1);
  EXPECT_FALSE(scene.added.inside);
  EXPECT_EQ(scene.cameras[0].name, "fitted");
}

}  // namespace
}  // namespace carousel::scene
