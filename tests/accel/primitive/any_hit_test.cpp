// Non-opaque primitives, ray flags and spheres: the tree's answers against every primitive tested in turn.
#include "core/types/any_hit.h"

#include <cmath>

#include <boost/multiprecision/cpp_int.hpp>
#include <gtest/gtest.h>

#include "accel/exact/exact_triangle.h"
#include "tests/accel/structure/passing_scenes.h"
#include "tests/accel/traverse/brute_force_answers.h"
#include "tests/accel/traverse/levels.h"
#include "tests/accel/traverse/simd_guard.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

constexpr BuiltinScene kScenes[] = {BuiltinScene::kSpheres, BuiltinScene::kInstances, BuiltinScene::kSliver};

TEST(AnyHit, GivesOneAnswerForEveryTree) {
  for (const BuiltinScene builtin : kScenes) {
    for (const std::uint32_t balls : {0u, 20u}) {
      const scene::Scene scene = passing_scene(builtin, balls, run_seed());
      const RayBatch rays = wishing_rays(scene, 900, run_seed() + 1);
      const HashedStop stop(0.4);
      const BruteForceAnswers brute(scene, rays, {}, &stop);
      const BruteForceAnswers solid(scene, rays);
      for (const std::int64_t width : {2, 5, 8}) {
        for (const std::int64_t leaf : {1, 4, 16}) {
          Accel accel = build_sequential(scene, width, leaf);
          EXPECT_EQ(solid.differences(accel), 0u) << "nobody asked";
          EXPECT_GT(brute.differences(accel), rays.size() / 20) << "asking must matter";
          accel.any_hit = &stop;
          EXPECT_EQ(brute.differences(accel), 0u) << "width " << width << " leaf " << leaf;
        }
      }
    }
  }
}

TEST(AnyHit, GivesOneAnswerAtEveryLevelAndOnEveryTarget) {
  const scene::Scene scene = passing_scene(BuiltinScene::kInstances, 20, run_seed() + 2);
  const RayBatch rays = wishing_rays(scene, 200, run_seed() + 3);
  const HashedStop stop(0.4);
  for (const AccuracyConfig& accuracy : triangle_and_box_levels()) {
    const BruteForceAnswers brute(scene, rays, accuracy, &stop);
    Accel accel = build_sequential(scene, 8, 4, accuracy);
    accel.any_hit = &stop;
    for (const SimdTarget target : usable_simd_targets()) {
      const SimdGuard guard;
      select_simd_target(target);
      EXPECT_EQ(brute.differences(accel), 0u) << text(accuracy) << " target " << static_cast<int>(target);
    }
  }
}

TEST(AnyHit, IsAskedOnlyWhereSomethingMayPass) {
  const scene::Scene scene = passing_scene(BuiltinScene::kTerrain, 0, 1);
  const HashedStop never(0);
  Accel accel = build_sequential(scene);
  accel.any_hit = &never;
  RayBatch rays = mixed_rays(scene, 600, 5);
  HitBatch hits;
  IntersectionCounts counts;
  trace_depth_first(accel, rays, hits, counts);
  EXPECT_GT(counts.any_hit_calls, 100u);
  EXPECT_EQ(counts.any_hit_calls, never.any_hit_calls());
  for (const RayResult& r : hits)
    if (r.hit.valid()) {
      EXPECT_EQ(scene.meshes[0].triangle_materials[r.hit.primitive], MaterialId(0))
          << "the others let everything through";
    }

  for (RayRequest& ray : rays) ray.tag.flags = kRayForceOpaque;
  const std::uint64_t before = never.any_hit_calls();
  trace_depth_first(accel, rays, hits, counts);
  EXPECT_EQ(never.any_hit_calls(), before) << "wished not to be asked";
}

TEST(AnyHit, AnswersKeepTheirWishes) {
  const scene::Scene scene = passing_scene(BuiltinScene::kTerrain, 0, 1);
  RayBatch rays = mixed_rays(scene, 60, 5);
  for (RayRequest& ray : rays) ray.tag.flags = kRayCullBack | kRayForceOpaque;
  for (const RayResult& r : trace(build_sequential(scene), rays))
    EXPECT_EQ(r.tag.flags, kRayCullBack | kRayForceOpaque);
}

// A closed ball seen from without: its near half shows its front, its far half its back, mirrored or not.
// Others reported this kind of fault: FBX2glTF 31, GLTFKit2 26.
TEST(AnyHit, CullsByTheSideThatShows) {
  for (const float mirror : {1.0f, -1.0f}) {
    for (const bool procedural : {false, true}) {
      scene::Scene scene = procedural ? empty_scene() : icosphere_scene(3);
      if (procedural) {
        scene.meshes.emplace_back().spheres.push_back({Vec3{0}, 1, MaterialId(0)});
        add_instance(scene, 0);
      }
      scene.instances[0].world_from_model.linear[0][0] = mirror;
      const Accel accel = build_sequential(scene);
      RayRequest ray = ray_to({0.1f, 0.2f, 5}, {0, 0, -1});
      EXPECT_NEAR(trace_one(accel, ray).t, 4.0f, 0.05f);
      ray.tag.flags = kRayCullBack;
      EXPECT_NEAR(trace_one(accel, ray).t, 4.0f, 0.05f);
      ray.tag.flags = kRayCullFront;
      EXPECT_NEAR(trace_one(accel, ray).t, 6.0f, 0.05f);
      ray.tag.flags = kRayCullFront | kRayCullBack;
      EXPECT_FALSE(trace_one(accel, ray).valid());
    }
  }
}

TEST(ExactFacing, HasTheSignOfTheExactTripleProduct) {
  Random random(run_seed());
  int zeros = 0;
  for (int i = 0; i < 20000; ++i) {
    // On a coarse lattice many triangles are seen edge-on, and next to it some nearly.
    const auto coarse = [&] {
      Vec3 p;
      for (int axis = 0; axis < 3; ++axis) {
        p[axis] = static_cast<float>(static_cast<int>(random.below(5)) - 2);
        if (random.below(4) == 0) p[axis] = std::nextafter(p[axis], random.below(2) == 0 ? -9.0f : 9.0f);
        if (i % 3 == 0) p[axis] += 1e6f;
      }
      return p;
    };
    const std::array<Vec3, 3> p{coarse(), coarse(), coarse()};
    Vec3 d = coarse();
    if (i % 3 == 0) d -= Vec3{1e6f};
    // In integers: all numbers are multiples of 2^-149.
    using Whole = boost::multiprecision::cpp_int;
    const auto whole = [](float x) { return Whole(std::ldexp(double{x}, 149)); };
    Whole sum = 0;
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      sum += whole(d[a]) * ((whole(p[1][b]) - whole(p[0][b])) * (whole(p[2][c]) - whole(p[0][c])) -
                            (whole(p[1][c]) - whole(p[0][c])) * (whole(p[2][b]) - whole(p[0][b])));
    }
    const int expected = sum < 0 ? 1 : sum > 0 ? -1 : 0;
    zeros += expected == 0;
    ASSERT_EQ(exact_facing(d, p), expected) << "case " << i << " seed " << run_seed();
  }
  EXPECT_GT(zeros, 500);
  EXPECT_LT(zeros, 15000);
}

}  // namespace
}  // namespace carousel::accel
