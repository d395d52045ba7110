// The oracle of `verify: reference` against brute force, which tests all that it leaves out, and against the tracer.
#include "accel/traverse/hit_oracle.h"

#include <gtest/gtest.h>

#include "accel/traverse/verifying_workload.h"
#include "tests/accel/structure/passing_scenes.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/brute_force_answers.h"
#include "tests/accel/traverse/levels.h"

namespace carousel::accel {
namespace {

/// Differences between the oracle and brute force; with `accel` between the oracle and the tracer.
std::size_t differences(const scene::Scene& scene, const RayBatch& rays, const AccuracyConfig& accuracy,
                        const AnyHit* any_hit, const Accel* accel = nullptr) {
  const HitOracle oracle(scene, accuracy, any_hit);
  HitBatch expected;
  if (accel != nullptr)
    expected = trace(*accel, rays);
  else
    for (const RayRequest& ray : rays)
      expected.push_back({ray.ray, brute_force(scene, ray, accuracy, any_hit), ray.tag});
  std::size_t differences = 0, hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    differences += !same_result(expected[i], {rays[i].ray, oracle.trace(rays[i]), rays[i].tag});
    hits += expected[i].hit.valid();
  }
  EXPECT_GT(hits, rays.size() / 20);
  return differences;
}

TEST(HitOracle, AgreesWithBruteForceAtEveryLevelOfAccuracy) {
  const HashedStop any_hit(0.5);
  for (const std::int64_t levels : {2, 4}) {
    const scene::Scene scene = passing_scene(BuiltinScene::kInstances, 8, 5, levels);
    for (const auto& transform : kEnumNames<TransformLevel>)
      for (AccuracyConfig accuracy : triangle_and_box_levels()) {
        accuracy.transform = transform.value;
        EXPECT_EQ(differences(scene, wishing_rays(scene, 60, 6), accuracy, &any_hit), 0u)
            << text(accuracy) << " " << transform.name;
      }
  }
}

TEST(HitOracle, AgreesWithTheTracerOnLargerScenes) {
  const HashedStop any_hit(0.3);
  for (const BuiltinScene builtin : {BuiltinScene::kTerrain, BuiltinScene::kSpheres, BuiltinScene::kSliver}) {
    const scene::Scene scene = small_builtin(builtin, 5000);
    const Accel accel = build_sequential(scene);
    EXPECT_EQ(differences(scene, mixed_rays(scene, 3000, 8), {}, nullptr, &accel), 0u);
  }
  const scene::Scene scene = passing_scene(BuiltinScene::kTerrain, 20, 9);
  Accel accel = build_sequential(scene);
  accel.any_hit = &any_hit;
  EXPECT_EQ(differences(scene, wishing_rays(scene, 3000, 9), {}, &any_hit, &accel), 0u);
}

TEST(HitOracle, KnowsFlattenedInstancesAndEmptyMeshes) {
  scene::Scene scene = icosphere_scene(2);
  add_instance(scene, 0, {Mat3(Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 0}), {0, 0, 2}});
  const RayBatch rays = mixed_rays(scene, 500, 3);
  add_instance(scene, add_mesh(scene, {}));
  const Accel accel = build_sequential(scene);
  ASSERT_EQ(accel.baked_instances, 1u);
  EXPECT_EQ(differences(scene, rays, {}, nullptr), 0u);
  EXPECT_EQ(differences(scene, rays, {}, nullptr, &accel), 0u);
  EXPECT_FALSE(HitOracle(empty_scene(), {}, nullptr).trace(ray_to({0, 0, -3}, {0, 0, 1})).valid());
}

TEST(HitOracle, NeedsNoMoreMemoryThanForetold) {
  for (const BuiltinScene builtin : {BuiltinScene::kTerrain, BuiltinScene::kInstances, BuiltinScene::kSliver}) {
    const scene::Scene scene = small_builtin(builtin, 3001, 77);
    const std::size_t bytes = HitOracle(scene, {}, nullptr).size_bytes(), foretold = HitOracle::foretold_bytes(scene);
    EXPECT_LE(bytes, foretold);
    EXPECT_GE(3 * bytes, foretold);
  }
}

}  // namespace
}  // namespace carousel::accel
