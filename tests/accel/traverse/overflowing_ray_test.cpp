// Rays that overflow, or lose their direction, on their way into the space of an instance of extreme scale: infinite or
// not a number along some axes or all. They hit or miss as every primitive tested in scalar code says.
#include <cmath>

#include <gtest/gtest.h>

#include "accel/traverse/ray_check.h"
#include "scene/builtin/random_rotation.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/brute_force_answers.h"
#include "tests/accel/traverse/levels.h"
#include "tests/accel/traverse/simd_guard.h"
#include "tests/accel/traverse/test_rays.h"

namespace carousel::accel {
namespace {

/// A number of any order of magnitude from 10^-`orders` to 10^`orders`.
float any_order(Random& random, float orders) {
  return std::pow(10.0f, random.uniform(-orders, orders));
}

/// A few turned instances of two meshes, ordinary ones and ones of extreme scale.
scene::Scene extreme_scene(Random& random) {
  scene::Scene scene = icosphere_scene(1);
  scene.instances.clear();
  scene::Mesh mixed;
  scene::add_icosphere(mixed, Vec3{0.5f}, 0.5f, 0, MaterialId(0));
  mixed.spheres.push_back({Vec3{-0.5f}, 0.5f, MaterialId(0)});
  const std::uint32_t second = add_mesh(scene, std::move(mixed));
  scene::HashRandom turns(random.below(1u << 30), 0);
  const std::uint32_t count = 1 + random.below(6);
  for (std::uint32_t i = 0; i < count; ++i) {
    Vec3 scale(any_order(random, random.below(2) ? 36 : 1));
    if (random.below(3) == 0) scale[static_cast<int>(random.below(3))] *= random.uniform(0.5f, 2.0f);
    scene::Affine placement{
        scene::random_rotation(turns) * Mat3(Vec3{scale.x, 0, 0}, Vec3{0, scale.y, 0}, Vec3{0, 0, scale.z}), Vec3{0}};
    if (random.below(2)) placement.translation = random.in_box(Vec3{-9}, Vec3{9});
    add_instance(scene, random.below(2) ? second : 0, placement);
  }
  return scene;
}

RayBatch odd_rays(const scene::Scene& scene, Random& random, std::size_t count) {
  RayBatch rays;
  while (rays.size() < count) {
    const Vec3 to = random.below(3) ? random_triangle(scene, random)[0] : random.in_box(Vec3{-3}, Vec3{3});
    const Vec3 from = random.in_box(Vec3{-1}, Vec3{1}) * any_order(random, random.below(2) ? 37 : 2);
    RayRequest ray = ray_to(from, (to - from) * any_order(random, random.below(2) ? 30 : 0));
    if (random.below(8) == 0) ray.ray.direction[static_cast<int>(random.below(3))] = 0;
    if (random.below(8) == 0) ray.tag.flags = random.below(2) ? kRayCullBack : kRayCullFront;
    if (random.below(8) == 0) ray.tag.kind = RayKind::kShadow;
    if (valid(ray.ray)) rays.push_back(ray);
  }
  return rays;
}

/// Differences from brute force over `scenes` random scenes of structures built so.
std::size_t differences(std::uint64_t seed, int scenes, const BvhConfig& bvh, const AccuracyConfig& accuracy,
                        const CullPlanesConfig& planes = {}) {
  std::size_t differences = 0, hits = 0;
  for (int i = 0; i < scenes; ++i) {
    Random random(seed + static_cast<std::uint64_t>(i));
    const scene::Scene scene = extreme_scene(random);
    const BruteForceAnswers brute(scene, odd_rays(scene, random, 60), accuracy);
    differences += brute.differences(build(scene, bvh, *make_sequential_executor(), accuracy, planes));
    hits += brute.hits();
  }
  EXPECT_GT(hits, static_cast<std::size_t>(scenes));
  return differences;
}

TEST(OverflowingRay, HitsOrMissesAtEveryLevelOfAccuracy) {
  for (const auto& transform : kEnumNames<TransformLevel>)
    for (AccuracyConfig accuracy : triangle_and_box_levels()) {
      accuracy.transform = transform.value;
      EXPECT_EQ(differences(100, 12, {}, accuracy), 0u) << text(accuracy) << " " << transform.name;
    }
}

TEST(OverflowingRay, HitsOrMissesOnEverySimdTarget) {
  const SimdGuard guard;
  for (const SimdTarget target : usable_simd_targets()) {
    select_simd_target(target);
    EXPECT_EQ(differences(300, 60, {}, {}), 0u) << enum_name(target);
  }
}

TEST(OverflowingRay, HitsOrMissesInEveryStructure) {
  const auto expect_none = [](const char* what, const BvhConfig& bvh, const CullPlanesConfig& planes = {}) {
    EXPECT_EQ(differences(500, 60, bvh, {}, planes), 0u) << what;
  };
  for (const std::int64_t width : {2, 4, 7, 8}) {
    BvhConfig bvh;
    bvh.width = width;
    expect_none("width", bvh);
  }
  BvhConfig bvh;
  bvh.storage = BvhConfig::Storage::kQuantised;
  expect_none("quantised", bvh);
  bvh = {};
  bvh.elements = BvhConfig::Elements::kSpheres;
  expect_none("spheres", bvh);
  bvh.elements = BvhConfig::Elements::kOrientedBoxes;
  expect_none("oriented boxes", bvh);
  bvh = {};
  bvh.merge = BvhConfig::Merge::kWorld;
  bvh.mixed_triangles = bvh.top_triangles = 4;
  expect_none("held leaves", bvh);
  CullPlanesConfig planes;
  planes.count = 4;
  planes.nodes = CullPlanesConfig::Nodes::kAll;
  expect_none("planes", {}, planes);
}

}  // namespace
}  // namespace carousel::accel
