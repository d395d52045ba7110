// Structures of quantised nodes against those of full ones: hits to the bit, of rays that graze turned instances and of
// rays from far away, whose hits often lie beside the box of their instance and then are none.
#include <gtest/gtest.h>

#include "accel/builders/quantised_boxes.h"
#include "accel/traverse/verifying_workload.h"
#include "scene/builtin/random_rotation.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/levels.h"
#include "tests/accel/traverse/test_rays.h"

namespace carousel::accel {
namespace {

using Storage = BvhConfig::Storage;

Accel stored(const scene::Scene& scene, Storage storage, const AccuracyConfig& accuracy, BvhConfig bvh = {}) {
  bvh.storage = storage;
  return build(scene, bvh, *make_sequential_executor(), accuracy);
}

scene::Scene turned_boxes(std::uint64_t seed, int instances) {
  Random random(seed);
  scene::HashRandom turns(seed, 1);
  scene::Scene scene = icosphere_scene(0);
  scene.instances.clear();
  for (int i = 0; i < instances; ++i) {
    Mat3 linear = scene::random_rotation(turns);
    for (int c = 0; c < 3; ++c) linear[c] *= random.uniform(0.2f, 0.8f);
    add_instance(scene, 0, {linear, random.in_box(Vec3{-10}, Vec3{10})});
  }
  return scene;
}

/// Rays past vertices from `distance` away. Two of three run at a right angle to one axis and nearly along another: for
/// these the box test has the least slack, so that many hits, by the rounding of a far ray, lie beside the box.
RayBatch grazing_rays(const scene::Scene& scene, std::size_t count, std::uint64_t seed, float distance) {
  Random random(seed);
  RayBatch rays;
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<Vec3, 3> p = random_triangle(scene, random);
    const Vec3 at = random.below(2) ? p[0] : p[0] + random.uniform() * (p[1] - p[0]);
    Vec3 direction = glm::normalize(random.in_box(Vec3{-1}, Vec3{1}) + Vec3{1e-3f});
    if (i % 3 != 0) {
      const int axis = static_cast<int>(random.below(3)), next = (axis + 1 + static_cast<int>(random.below(2))) % 3;
      direction[axis] = 0;
      direction[next] *= random.below(2) ? 0.1f : 0.01f;
    }
    rays.push_back(ray_to(at - distance * direction, direction));
  }
  return rays;
}

struct Difference {
  std::size_t hits = 0, others = 0;
};

Difference compare(const Accel& full, const Accel& quantised, const RayBatch& rays) {
  Difference out;
  const HitBatch expected = trace(full, rays);
  for (auto* const tracer : {trace_depth_first, trace_depth_first_interleaved}) {
    HitBatch got;
    IntersectionCounts counts;
    tracer(quantised, rays, got, counts);
    for (std::size_t i = 0; i < rays.size(); ++i) out.others += !same_result(expected[i], got.at(i));
  }
  for (const RayResult& r : expected) out.hits += r.hit.valid();
  return out;
}

TEST(QuantisedHits, AreThoseOfFullNodesAtEveryLevelOfAccuracy) {
  const scene::Scene scene = turned_boxes(1, 40);
  for (const auto& triangle : kEnumNames<TriangleLevel>)
    for (const auto& transform : kEnumNames<TransformLevel>) {
      AccuracyConfig accuracy;
      accuracy.triangle = triangle.value;
      accuracy.transform = transform.value;
      const Accel full = stored(scene, Storage::kFull, accuracy), small = stored(scene, Storage::kQuantised, accuracy);
      for (const float distance : {30.0f, 1e4f, 1e7f}) {
        const Difference found = compare(full, small, grazing_rays(scene, 800, 3, distance));
        EXPECT_GT(found.hits, 200u);
        EXPECT_EQ(found.others, 0u) << triangle.name << " " << transform.name << " " << distance;
      }
    }
}

TEST(QuantisedHits, AreThoseOfFullNodesInManyScenes) {
  std::size_t others = 0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    const scene::Scene scene = turned_boxes(seed, 3 + static_cast<int>(seed % 20));
    BvhConfig bvh;
    bvh.width = 2 + static_cast<std::int64_t>(seed % 7);
    const Accel full = stored(scene, Storage::kFull, {}, bvh), small = stored(scene, Storage::kQuantised, {}, bvh);
    for (const float distance : {1.0f, 1e7f})
      others += compare(full, small, grazing_rays(scene, 200, seed, distance)).others;
  }
  EXPECT_EQ(others, 0u);
}

/// Larger boxes let rays in that graze an instance: otherwise the two tests above would prove nothing.
TEST(QuantisedHits, NeedTheBoxesOfTurnedInstances) {
  const scene::Scene scene = turned_boxes(1, 40);
  const Accel full = stored(scene, Storage::kFull, {});
  Accel larger = stored(scene, Storage::kQuantised, {});
  const std::vector<std::uint32_t> kept = unquantised_nodes(larger);
  ASSERT_FALSE(kept.empty());
  for (const std::uint32_t n : kept) {
    for (int axis = 0; axis < 3; ++axis)
      for (int lane = 0; lane < larger.nodes[n].count; ++lane) {
        EXPECT_EQ(larger.nodes[n].plane[axis][lane], full.nodes[n].plane[axis][lane]);
        larger.nodes[n].plane[axis][lane] -= 1;
        larger.nodes[n].plane[axis + 3][lane] += 1;
      }
  }
  EXPECT_GT(compare(full, larger, grazing_rays(scene, 8000, 3, 1e7f)).others, 0u);
}

TEST(QuantisedHits, KeepTheBoxesOfTurnedInstancesOnly) {
  scene::Scene scene = turned_boxes(1, 40);
  for (scene::Instance& instance : scene.instances) instance.world_from_model = {};
  EXPECT_TRUE(unquantised_nodes(stored(scene, Storage::kQuantised, {})).empty());
}

}  // namespace
}  // namespace carousel::accel
