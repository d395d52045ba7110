// Every level of the triangle and the box test: scalar code, every SIMD target and every tree give the same bits.
#include "tests/accel/traverse/levels.h"

#include <array>
#include <bit>
#include <set>

#include <gtest/gtest.h>

#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/brute_force_answers.h"
#include "tests/accel/traverse/simd_guard.h"
#include "tests/accel/traverse/test_rays.h"

namespace carousel::accel {
namespace {

class Levels : public testing::TestWithParam<AccuracyConfig> {};

TEST_P(Levels, AgreeWithBruteForceForEveryTree) {
  for (const BuiltinScene builtin :
       {BuiltinScene::kCornell, BuiltinScene::kTerrain, BuiltinScene::kInstances, BuiltinScene::kSliver}) {
    const scene::Scene scene = small_builtin(builtin, 250, 6);
    const BruteForceAnswers brute(scene, mixed_rays(scene, 500, 41), GetParam());
    EXPECT_GT(brute.hits(), 120u);
    for (const std::int64_t width : {2, 3, 5, 8})
      for (const std::int64_t leaf : {1, 4, 16})
        EXPECT_EQ(brute.differences(build_sequential(scene, width, leaf, GetParam())), 0u)
            << enum_name(builtin) << " width " << width << " leaf " << leaf;
  }
}

TEST_P(Levels, AgreeOnEverySimdTarget) {
  for (const BuiltinScene builtin : {BuiltinScene::kTerrain, BuiltinScene::kInstances, BuiltinScene::kSliver}) {
    const scene::Scene scene = small_builtin(builtin, 200, 6);
    const BruteForceAnswers brute(scene, mixed_rays(scene, 500, 42), GetParam());
    const Accel accel = build_sequential(scene, 8, 4, GetParam());
    for (const SimdTarget target : usable_simd_targets()) {
      const SimdGuard guard;
      select_simd_target(target);
      EXPECT_EQ(brute.differences(accel), 0u) << enum_name(builtin) << " target " << enum_name(target);
    }
  }
}

TEST_P(Levels, AgreeOnRaysOfAnyBits) {
  const scene::Scene scene = small_builtin(BuiltinScene::kInstances, 100, 8);
  const BruteForceAnswers brute(scene, rays_of_any_bits(800, 43), GetParam());
  EXPECT_GT(brute.hits(), 20u);
  for (const SimdTarget target : usable_simd_targets()) {
    const SimdGuard guard;
    select_simd_target(target);
    for (const std::int64_t width : {2, 8})
      EXPECT_EQ(brute.differences(build_sequential(scene, width, 4, GetParam())), 0u);
  }
}

TEST_P(Levels, AgreeOnGeometryOfAnyScale) {
  for (const float scale : {1e-38f, 1e-20f, 1e-6f, 1e6f, 1e15f, 1e25f}) {
    scene::Scene scene = icosphere_scene(1, Vec3{0}, 1);
    for (Vec3& p : scene.meshes[0].positions) p = p * scale;
    const BruteForceAnswers brute(scene, mixed_rays(scene, 400, 44), GetParam());
    EXPECT_EQ(brute.differences(build_sequential(scene, 8, 4, GetParam())), 0u) << scale;
  }
}

TEST_P(Levels, AgreeOnDegenerateTriangles) {
  Random random(45);
  std::vector<Vec3> corners;
  for (int i = 0; i < 60; ++i) {
    const Vec3 a = random.in_box(Vec3{-1}, Vec3{1}), b = random.in_box(Vec3{-1}, Vec3{1});
    const Vec3 c = i % 4 == 0 ? a : i % 4 == 1 ? 0.5f * (a + b) : i % 4 == 2 ? b : random.in_box(Vec3{-1}, Vec3{1});
    corners.insert(corners.end(), {a, i % 8 == 0 ? a : b, c});
  }
  const scene::Scene scene = scene_of(soup(corners));
  const BruteForceAnswers brute(scene, mixed_rays(scene, 800, 46), GetParam());
  for (const std::int64_t leaf : {1, 4, 16})
    EXPECT_EQ(brute.differences(build_sequential(scene, 8, leaf, GetParam())), 0u);
}

// Faces on faces: t' is often the entry into the triangle's box, and ties are many.
TEST_P(Levels, AgreeOnCoincidentFacesAlongTheAxes) {
  Random random(48);
  std::vector<Vec3> faces, corners;
  for (int i = 0; i < 12; ++i) {
    Vec3 p[3] = {random.in_box(Vec3{-1}, Vec3{1}), random.in_box(Vec3{-1}, Vec3{1}), random.in_box(Vec3{-1}, Vec3{1})};
    p[1][i % 3] = p[2][i % 3] = p[0][i % 3];
    faces.insert(faces.end(), p, p + 3);
  }
  for (int i = 0; i < 60; ++i) {
    const std::size_t face = 3 * random.below(12), turn = random.below(3);
    for (std::size_t k = 0; k < 3; ++k) corners.push_back(faces[face + (k + turn) % 3]);
  }
  const scene::Scene scene = scene_of(soup(corners));
  const BruteForceAnswers brute(scene, mixed_rays(scene, 1500, 49), GetParam());
  for (const std::int64_t leaf : {1, 4, 16})
    EXPECT_EQ(brute.differences(build_sequential(scene, 8, leaf, GetParam())), 0u);
}

INSTANTIATE_TEST_SUITE_P(Every, Levels, testing::ValuesIn(triangle_and_box_levels()), [](const auto& level) {
  return std::string(enum_name(level.param.triangle)) + "_" + std::string(enum_name(level.param.box));
});

// The test of the test: levels that were one and the same in disguise would pass everything above.
TEST(LevelsDiffer, EachTriangleLevelGivesOtherBits) {
  const scene::Scene scene = small_builtin(BuiltinScene::kTerrain, 250);
  const RayBatch rays = mixed_rays(scene, 2000, 47);
  std::set<std::array<std::uint64_t, 2>> digests;
  for (const AccuracyConfig& accuracy : triangle_and_box_levels()) {
    if (accuracy.box != BoxLevel::kConservative) continue;
    std::array<std::uint64_t, 2> sum{};
    for (const RayResult& r : trace(build_sequential(scene, 8, 4, accuracy), rays)) {
      sum[0] += std::bit_cast<std::uint32_t>(r.hit.t);
      sum[1] += std::bit_cast<std::uint32_t>(r.hit.u) * std::uint64_t{0x9e3779b97f4a7c15};
    }
    digests.insert(sum);
  }
  EXPECT_EQ(digests.size(), 4u);
}

}  // namespace
}  // namespace carousel::accel
