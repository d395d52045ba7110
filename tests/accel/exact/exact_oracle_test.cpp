#include "tests/accel/exact/exact_oracle.h"

#include <gtest/gtest.h>

#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/test_rays.h"

namespace carousel::accel {
namespace {

// Right answers pass, wrong ones of each kind do not.
TEST(ExactOracle, RefusesWrongAnswers) {
  for (const BuiltinScene builtin : {BuiltinScene::kSpheres, BuiltinScene::kTerrain, BuiltinScene::kInstances}) {
    const scene::Scene scene = small_builtin(builtin, 1000, 5);
    const Accel accel = build_sequential(scene);
    const ExactOracle oracle(scene);
    std::size_t hits = 0, missed = 0, beside = 0, off = 0, invented = 0, misses = 0;
    RayBatch rays;
    Random random(81);
    const Aabb bounds = scene.bounds();
    for (int i = 0; i < 1500; ++i) {
      const Vec3 from = random.in_box(bounds.lo - bounds.extent(), bounds.hi + bounds.extent());
      rays.push_back(ray_to(from, random.in_box(bounds.lo, bounds.hi) - from));
    }
    for (const RayResult& r : trace(accel, rays)) {
      ASSERT_TRUE(oracle.acceptable(r.ray, r.hit));
      Hit wrong = r.hit;
      if (!r.hit.valid()) {
        ++misses;
        wrong = {1, 0.3f, 0.3f, 0, 7};
        invented += !oracle.acceptable(r.ray, wrong);
        continue;
      }
      ++hits;
      missed += !oracle.acceptable(r.ray, Hit{});
      wrong.primitive = r.hit.primitive == 0 ? 1 : r.hit.primitive - 1;
      beside += !oracle.acceptable(r.ray, wrong);
      wrong = r.hit;
      wrong.t *= 1.1f;
      off += !oracle.acceptable(r.ray, wrong);
    }
    // A few rays pass an edge or graze a surface and leave a choice.
    EXPECT_GT(hits, 300u);
    EXPECT_GT(missed, hits * 99 / 100);
    EXPECT_GT(beside, hits * 99 / 100);
    EXPECT_GT(off, hits * 95 / 100);  // a grazing ray may meet its triangle anywhere
    EXPECT_GT(invented, misses * 99 / 100);
  }
}

// A ray at an edge that two triangles share may be given to either, but not to neither.
TEST(ExactOracle, TellsALeakFromASilhouette) {
  const scene::Scene scene = scene_of([] {
    scene::Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
  }());
  const ExactOracle oracle(scene);
  const Ray diagonal{{0.25f, 0.25f, 2}, 0, {0, 0, -1}, kInfinity}, border{{1, 0.25f, 2}, 0, {0, 0, -1}, kInfinity};
  EXPECT_TRUE(oracle.acceptable(diagonal, {2, 0, 0, 0, 0}));
  EXPECT_TRUE(oracle.acceptable(diagonal, {2, 0, 0, 0, 1}));
  EXPECT_FALSE(oracle.acceptable(diagonal, Hit{}));
  EXPECT_TRUE(oracle.acceptable(border, {2, 0, 0, 0, 0}));
  EXPECT_TRUE(oracle.acceptable(border, Hit{}));
  EXPECT_FALSE(oracle.acceptable(border, {2, 0, 0, 0, 1}));
}

}  // namespace
}  // namespace carousel::accel
