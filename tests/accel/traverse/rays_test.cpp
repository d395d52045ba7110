// Rays without a meaning, scenes without geometry, shadow rays.
#include <limits>

#include <gtest/gtest.h>

#include "accel/traverse/ray_check.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/brute_force.h"
#include "tests/accel/traverse/test_rays.h"

namespace carousel::accel {
namespace {

void expect_canonical_miss(const Hit& hit) {
  EXPECT_FALSE(hit.valid());
  EXPECT_EQ(hit.t, kInfinity);
  EXPECT_EQ(hit.u, 0);
  EXPECT_EQ(hit.v, 0);
}

TEST(InvalidRay, CompletesAsMiss) {
  const scene::Scene scene = icosphere_scene(2);
  const Accel accel = build_sequential(scene);
  const RayRequest good = ray_to({0, 0, -3}, {0, 0, 1});
  ASSERT_TRUE(trace_one(accel, good).valid());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<RayRequest> bad;
  for (const float value : {nan, kInfinity, -kInfinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      bad.push_back(good), bad.back().ray.origin[axis] = value;
      bad.push_back(good), bad.back().ray.direction[axis] = value;
    }
  }
  bad.push_back(good), bad.back().ray.direction = Vec3{0};
  bad.push_back(good), bad.back().ray.direction = Vec3{-0.0f};
  bad.push_back(good), bad.back().ray.tmin = nan;
  bad.push_back(good), bad.back().ray.tmax = nan;
  bad.push_back(good), bad.back().ray.tmin = -1;
  bad.push_back(good), bad.back().ray.tmin = 3, bad.back().ray.tmax = 2.5f;
  bad.push_back(good), bad.back().ray.tmax = -kInfinity;
  for (std::size_t i = 0; i < bad.size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_FALSE(valid(bad[i].ray));
    for (const RayKind kind : {RayKind::kCamera, RayKind::kShadow}) {
      bad[i].tag.kind = kind;
      expect_canonical_miss(trace_one(accel, bad[i]));
      expect_canonical_miss(brute_force(scene, bad[i]));
    }
  }
}

TEST(Ray, MissIsCanonicalWithFiniteTmax) {
  const Accel accel = build_sequential(icosphere_scene(1));
  expect_canonical_miss(trace_one(accel, ray_to({0, 0, -3}, {0, 1, 0}, 0, 7)));
  expect_canonical_miss(trace_one(accel, ray_to({0, 0, -3}, {0, 0, 1}, 0, 1.5f)));
  expect_canonical_miss(trace_one(accel, ray_to({0, 0, -3}, {0, 0, 1}, 4.5f)));
}

// Other rays fill a ray's waits, and change nothing of its way; a shadow ray's way ends at a hit in a leaf.
TEST(RaysInTurn, MakeTheTestsThatEachMakesAlone) {
  for (const BuiltinScene builtin : {BuiltinScene::kTerrain, BuiltinScene::kSpheres, BuiltinScene::kInstances}) {
    const scene::Scene scene = small_builtin(builtin);
    const RayBatch rays = mixed_rays(scene, 700, 15);
    for (std::int64_t width = 2; width <= 8; ++width)
      for (const std::int64_t leaf : {1, 4, 16}) {
        const Accel accel = build_sequential(scene, width, leaf);
        HitBatch hits;
        IntersectionCounts alone, in_turn;
        trace_depth_first(accel, rays, hits, alone);
        trace_depth_first_interleaved(accel, rays, hits, in_turn);
        EXPECT_GT(alone.triangle, 0u);
        for (const auto& counter : IntersectionCounts::counters())
          EXPECT_EQ(counter.value(alone), counter.value(in_turn)) << counter.name << ", width " << width;
      }
  }
}

TEST(Ray, HitsAtBothEndsOfItsRange) {
  const scene::Scene scene = scene_of(soup({{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}));
  const Accel accel = build_sequential(scene);
  EXPECT_EQ(trace_one(accel, ray_to({0, 0, -2}, {0, 0, 1}, 2, 3)).t, 2);
  EXPECT_EQ(trace_one(accel, ray_to({0, 0, -2}, {0, 0, 1}, 1, 2)).t, 2);
  EXPECT_EQ(trace_one(accel, ray_to({0, 0, -2}, {0, 0, 1}, 2, 2)).t, 2);
  EXPECT_FALSE(trace_one(accel, ray_to({0, 0, -2}, {0, 0, 1}, 0, std::nextafter(2.0f, 0.0f))).valid());
}

TEST(Ray, WeightsBelongToSecondAndThirdVertex) {
  const scene::Scene scene = scene_of(soup({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}));
  const Hit hit = trace_one(build_sequential(scene), ray_to({1, 2, 1}, {0, 0, -1}));
  ASSERT_TRUE(hit.valid());
  EXPECT_EQ(hit.t, 1);
  EXPECT_EQ(hit.u, 0.25f);
  EXPECT_EQ(hit.v, 0.5f);
}

TEST(EmptyScene, GivesMisses) {
  const Accel accel = build_sequential(empty_scene());
  ASSERT_TRUE(accel.root_key().ref.is_inner());
  EXPECT_EQ(accel.strip_size(accel.root_key()), 0);
  EXPECT_EQ(accel.triangles_below(accel.root_key()), 0u);
  expect_canonical_miss(trace_one(accel, ray_to({0, 0, -3}, {0, 0, 1})));
}

TEST(EmptyScene, MayHaveInstancesOfEmptyMeshes) {
  scene::Scene scene = icosphere_scene(0);
  const std::uint32_t nothing = add_mesh(scene, {});
  scene.instances.insert(scene.instances.begin(), {MeshId(nothing), {}});
  const Hit hit = trace_one(build_sequential(scene), ray_to({0, 0, -3}, {0.1f, 0.2f, 1}));
  ASSERT_TRUE(hit.valid());
  EXPECT_EQ(hit.instance, 1u);
  scene.instances.pop_back();
  expect_canonical_miss(trace_one(build_sequential(scene), ray_to({0, 0, -3}, {0.1f, 0.2f, 1})));
}

TEST(ShadowRay, AgreesWithClosestHit) {
  for (const BuiltinScene builtin : {BuiltinScene::kSpheres, BuiltinScene::kInstances, BuiltinScene::kSliver}) {
    const scene::Scene scene = small_builtin(builtin, 2000, 60);
    const Accel accel = build_sequential(scene);
    RayBatch closest = mixed_rays(scene, 6000, 21), any = closest;
    for (RayRequest& r : closest) r.tag.kind = RayKind::kBounce;
    for (RayRequest& r : any) r.tag.kind = RayKind::kShadow;
    const HitBatch a = trace(accel, closest), b = trace(accel, any);
    std::size_t occluded = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(a[i].hit.valid(), b[i].hit.valid()) << i;
      occluded += b[i].hit.valid();
      if (b[i].hit.valid()) {
        ASSERT_GE(b[i].hit.t, a[i].hit.t);
      }
    }
    EXPECT_GT(occluded, 1000u);
  }
}

}  // namespace
}  // namespace carousel::accel
