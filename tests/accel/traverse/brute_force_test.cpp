// The depth-first tracer against every triangle tested in scalar code: bits equal, over tree shapes and targets.
#include "tests/accel/traverse/brute_force.h"

#include <gtest/gtest.h>

#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/brute_force_answers.h"
#include "tests/accel/traverse/simd_guard.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

void expect_equal_for_every_tree(const scene::Scene& scene, std::size_t rays) {
  const BruteForceAnswers brute(scene, mixed_rays(scene, rays, 11));
  EXPECT_GT(brute.hits(), rays / 4);
  EXPECT_LT(brute.hits(), rays);
  for (std::int64_t width = 2; width <= 8; ++width)
    for (const std::int64_t leaf : {1, 4, 8, 16})
      EXPECT_EQ(brute.differences(build_sequential(scene, width, leaf)), 0u) << "width " << width << " leaf " << leaf;
}

TEST(BruteForce, AgreesOnCornellForEveryTree) {
  expect_equal_for_every_tree(small_builtin(BuiltinScene::kCornell), 1200);
}
TEST(BruteForce, AgreesOnSpheresForEveryTree) {
  expect_equal_for_every_tree(small_builtin(BuiltinScene::kSpheres), 1200);
}
TEST(BruteForce, AgreesOnTerrainForEveryTree) {
  expect_equal_for_every_tree(small_builtin(BuiltinScene::kTerrain), 1200);
}
TEST(BruteForce, AgreesOnInstancesForEveryTree) {
  expect_equal_for_every_tree(small_builtin(BuiltinScene::kInstances), 600);
}
TEST(BruteForce, AgreesOnSliverForEveryTree) {
  expect_equal_for_every_tree(small_builtin(BuiltinScene::kSliver), 1200);
}

TEST(BruteForce, AgreesOnEverySimdTarget) {
  const std::vector<SimdTarget> targets = usable_simd_targets();
#if defined(__x86_64__)
  EXPECT_GE(targets.size(), 3u);  // at least two baselines beside auto, or the test shows nothing
#endif
  for (const BuiltinScene builtin : {BuiltinScene::kTerrain, BuiltinScene::kInstances, BuiltinScene::kSliver}) {
    const scene::Scene scene = small_builtin(builtin, 200, 6);
    const BruteForceAnswers brute(scene, mixed_rays(scene, 900, 12));
    for (const std::int64_t width : {3, 8}) {
      const Accel accel = build_sequential(scene, width);
      for (const SimdTarget target : targets) {
        const SimdGuard guard;
        select_simd_target(target);
        EXPECT_EQ(brute.differences(accel), 0u) << "width " << width << " target " << static_cast<int>(target);
      }
    }
  }
}

// Origins and directions of any magnitude, far beyond what the tree was built for.
TEST(BruteForce, AgreesOnRaysOfAnyBits) {
  const scene::Scene scene = small_builtin(BuiltinScene::kInstances, 100, 8);
  const BruteForceAnswers brute(scene, rays_of_any_bits(1500, 13));
  EXPECT_GT(brute.hits(), 50u);
  for (const SimdTarget target : usable_simd_targets()) {
    const SimdGuard guard;
    select_simd_target(target);
    for (const std::int64_t width : {2, 8}) EXPECT_EQ(brute.differences(build_sequential(scene, width)), 0u);
  }
}

// Geometry at the ends of what floats can hold.
// Others reported this kind of fault: svenstaro/bvh 44, Ignis 3.
TEST(BruteForce, AgreesOnGeometryOfAnyScale) {
  for (const float scale : {1e-38f, 1e-20f, 1e-6f, 1e6f, 1e15f, 1e25f}) {
    scene::Scene scene = icosphere_scene(1, Vec3{0}, 1);
    for (Vec3& p : scene.meshes[0].positions) p = p * scale;
    const BruteForceAnswers brute(scene, mixed_rays(scene, 600, 14));
    EXPECT_EQ(brute.differences(build_sequential(scene)), 0u) << scale;
  }
}

TEST(BruteForce, AgreesOnSingularMirroredAndSkewedInstances) {
  scene::Scene scene = empty_scene();
  scene::Mesh ball;
  scene::add_icosphere(ball, Vec3{0}, 0.5f, 1, MaterialId(0));
  const std::uint32_t mesh = add_mesh(scene, ball);
  const auto place = [&](const Vec3& c0, const Vec3& c1, const Vec3& c2, const Vec3& t) {
    add_instance(scene, mesh, {Mat3(c0, c1, c2), t});
  };
  place({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0});
  place({-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 0});
  place({1, 0, 0}, {0, 0, 0}, {0, 0, 1}, {0, 2, 0});  // flattened: singular
  place({1, 1, 0}, {1, 1, 0}, {0, 0, 1}, {2, 2, 0});  // rank 2
  place({0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 2});  // a point
  place({1, 0.9f, 0}, {0, 1e-3f, 0}, {0.3f, 0, -2}, {2, 0, 2});
  place({1e-30f, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 2, 2});  // invertible in double; the inverse fits a float
  place({1e-39f, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 2, 2});  // its inverse does not
  const Accel accel = build_sequential(scene);
  EXPECT_EQ(accel.baked_instances, 4u);
  const BruteForceAnswers brute(scene, mixed_rays(scene, 1500, 15));
  EXPECT_GT(brute.hits(), 300u);
  for (const std::int64_t width : {2, 5, 8}) EXPECT_EQ(brute.differences(build_sequential(scene, width)), 0u);
}

TEST(BruteForce, AgreesOnSpheresInSkewedInstances) {
  scene::Scene scene = empty_scene();
  scene::Mesh ball;
  ball.spheres.push_back({Vec3{0.1f, 0, -0.2f}, 0.5f, MaterialId(0)});
  const std::uint32_t mesh = add_mesh(scene, ball);
  Random random(run_seed());
  for (int i = 0; i < 30; ++i) {
    const float far = i % 3 == 0 ? 1.0f : i % 3 == 1 ? 100.0f : 3000.0f;
    Mat3 linear(1);
    for (int c = 0; c < 3; ++c) linear[c] += random.in_box(Vec3{-0.7f}, Vec3{0.7f});
    if (i % 4 == 0) linear[1] *= i % 8 == 0 ? 1e-3f : 1e-30f;  // nearly flat
    add_instance(scene, mesh, {linear, far * random.in_box(Vec3{-1}, Vec3{1})});
  }
  const BruteForceAnswers brute(scene, mixed_rays(scene, 3000, run_seed()));
  EXPECT_GT(brute.hits(), 100u) << "CAROUSEL_SEED=" << run_seed();
  for (const std::int64_t width : {2, 8})
    EXPECT_EQ(brute.differences(build_sequential(scene, width)), 0u) << "CAROUSEL_SEED=" << run_seed();
}

// Others reported this kind of fault: svenstaro/bvh 44, Ignis 3.
TEST(BruteForce, AgreesOnDegenerateTriangles) {
  Random random(16);
  std::vector<Vec3> corners;
  for (int i = 0; i < 60; ++i) {
    const Vec3 a = random.in_box(Vec3{-1}, Vec3{1}), b = random.in_box(Vec3{-1}, Vec3{1});
    const Vec3 c = i % 4 == 0 ? a : i % 4 == 1 ? 0.5f * (a + b) : i % 4 == 2 ? b : random.in_box(Vec3{-1}, Vec3{1});
    corners.insert(corners.end(), {a, i % 8 == 0 ? a : b, c});
  }
  const scene::Scene scene = scene_of(soup(corners));
  const BruteForceAnswers brute(scene, mixed_rays(scene, 1500, 17));
  for (const std::int64_t leaf : {1, 4, 16}) EXPECT_EQ(brute.differences(build_sequential(scene, 8, leaf)), 0u);
}

}  // namespace
}  // namespace carousel::accel
