// Nodes of the top level that hold triangles of the world beside instances (`bvh.top_triangles`): the same hits as of
// every primitive tested in turn.
#include <gtest/gtest.h>

#include "tests/accel/structure/passing_scenes.h"
#include "tests/accel/traverse/brute_force_answers.h"
#include "tests/accel/traverse/levels.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

Accel build_with(const scene::Scene& scene, const BvhConfig& config, const AccuracyConfig& accuracy = {}) {
  return build(scene, config, *make_sequential_executor(), accuracy);
}

/// Instances with transforms among `plates`: meshes of one to three triangles that stand in the world as they are.
scene::Scene plates_and_instances(std::uint32_t plates, std::uint64_t seed) {
  scene::Scene scene = passing_scene(BuiltinScene::kInstances, 6, seed);
  Random random(seed);
  const Aabb bounds = small_builtin(BuiltinScene::kSpheres, 250).bounds();
  for (std::uint32_t i = 0; i < plates; ++i) {
    std::vector<Vec3> corners;
    for (std::uint32_t k = 3 * (1 + random.below(3)); k > 0; --k)
      corners.push_back(random.in_box(bounds.lo, bounds.hi));
    add_instance(scene, add_mesh(scene, soup(corners)));
  }
  return scene;
}

TEST(TopTriangles, StandInANodeWithInstances) {
  BvhConfig config;
  config.top_triangles = 3;
  const scene::Scene scene = plates_and_instances(8, run_seed());
  const Accel accel = build_with(scene, config);
  int mixed = 0, held = 0;
  for (const Node& node : accel.nodes) {
    if (node.direct == 0) continue;
    ASSERT_TRUE(node.above_instances);
    int boxes = 0;
    for (int lane = 0; lane < node.count; ++lane) {
      if ((node.direct >> lane & 1) == 0) {
        boxes += node.child[lane].is_instance();
        continue;
      }
      ++held;
      const InstanceNode& instance = accel.instances[node.child[lane].instance_index()];
      EXPECT_TRUE(instance.transform.identity);
      EXPECT_EQ(accel.held_leaf(node, lane), instance.root);
      EXPECT_LE(accel.held_leaf(node, lane).triangles(), 3u);
    }
    mixed += boxes > 0;
  }
  EXPECT_EQ(held, 9);  // the ground as well
  EXPECT_GT(mixed, 0);
  for (const Node& node : build_with(scene, {}).nodes) EXPECT_EQ(node.direct, 0);
}

TEST(TopTriangles, GiveOneAnswer) {
  const HashedStop stop(0.4);
  const scene::Scene scene = plates_and_instances(12, run_seed());
  const BruteForceAnswers brute(scene, wishing_rays(scene, 400, run_seed() + 1), {}, &stop);
  for (const auto elements : {BvhConfig::Elements::kBoxes, BvhConfig::Elements::kSpheres}) {
    for (const std::int64_t top : {0, 1, 2, 16}) {
      for (const std::int64_t width : {2, 8}) {
        BvhConfig config;
        config.elements = elements;
        config.top_triangles = top;
        config.mixed_triangles = top / 2;
        config.width = width;
        Accel accel = build_with(scene, config);
        accel.any_hit = &stop;
        EXPECT_EQ(brute.differences(accel), 0u) << enum_name(elements) << " top " << top << " width " << width;
      }
    }
  }
  EXPECT_GT(brute.hits(), 100u);
}

TEST(TopTriangles, GiveOneAnswerAtEveryLevel) {
  const scene::Scene scene = plates_and_instances(6, run_seed());
  const RayBatch rays = mixed_rays(scene, 50, run_seed());
  BvhConfig config;
  config.top_triangles = 4;
  for (const AccuracyConfig& accuracy : triangle_and_box_levels())
    EXPECT_EQ(BruteForceAnswers(scene, rays, accuracy).differences(build_with(scene, config, accuracy)), 0u)
        << text(accuracy);
}

// A plate in the top level: its box is not tested, its triangles always are.
TEST(TopTriangles, SpareBoxes) {
  const scene::Scene scene = plates_and_instances(12, run_seed());
  const RayBatch rays = mixed_rays(scene, 1000, run_seed());
  BvhConfig config;
  IntersectionCounts plain, held;
  HitBatch hits;
  trace_depth_first(build_with(scene, config), rays, hits, plain);
  config.top_triangles = 4;
  trace_depth_first(build_with(scene, config), rays, hits, held);
  EXPECT_LT(held.box, plain.box);
  EXPECT_GT(held.triangle, plain.triangle);
}

}  // namespace
}  // namespace carousel::accel
