// Bounding spheres and mixed nodes: the same hits as of every primitive tested in turn, whatever bounds them.
#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "accel/build/bounding_spheres.h"
#include "accel/planes/cull_planes.h"
#include "accel/structure/cull_plane.h"
#include "accel/structure/node_spheres.h"
#include "tests/accel/structure/passing_scenes.h"
#include "tests/accel/traverse/brute_force_answers.h"
#include "tests/accel/traverse/levels.h"
#include "tests/accel/traverse/simd_guard.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

using Elements = BvhConfig::Elements;

Accel build_with(const scene::Scene& scene, Elements elements, std::int64_t mixed, std::int64_t width = 8,
                 const AccuracyConfig& accuracy = {}) {
  BvhConfig config;
  config.elements = elements;
  config.mixed_triangles = mixed;
  config.width = width;
  return build(scene, config, *make_sequential_executor(), accuracy);
}

TEST(Elements, GiveOneAnswer) {
  const HashedStop stop(0.4);
  for (const BuiltinScene builtin :
       {BuiltinScene::kSpheres, BuiltinScene::kTerrain, BuiltinScene::kInstances, BuiltinScene::kSliver}) {
    const scene::Scene scene = passing_scene(builtin, 12, run_seed());
    const BruteForceAnswers brute(scene, wishing_rays(scene, 1200, run_seed() + 1), {}, &stop);
    for (const Elements elements : {Elements::kBoxes, Elements::kSpheres}) {
      for (const std::int64_t mixed : {0, 1, 3, 16}) {
        for (const std::int64_t width : {2, 8}) {
          Accel accel = build_with(scene, elements, mixed, width);
          accel.any_hit = &stop;
          EXPECT_EQ(brute.differences(accel), 0u) << enum_name(elements) << " mixed " << mixed << " width " << width;
        }
      }
    }
  }
}

TEST(Elements, GiveOneAnswerAtEveryLevelAndOnEveryTarget) {
  const scene::Scene scene = small_builtin(BuiltinScene::kInstances, 200, 6);
  const RayBatch rays = mixed_rays(scene, 250, run_seed());
  for (const AccuracyConfig& accuracy : triangle_and_box_levels()) {
    const BruteForceAnswers brute(scene, rays, accuracy);
    for (const Elements elements : {Elements::kBoxes, Elements::kSpheres}) {
      const Accel accel = build_with(scene, elements, 2, 8, accuracy);
      for (const SimdTarget target : usable_simd_targets()) {
        const SimdGuard guard;
        select_simd_target(target);
        EXPECT_EQ(brute.differences(accel), 0u) << text(accuracy) << ' ' << enum_name(elements);
      }
    }
  }
}

// Far more rays than every primitive could be tested with: boxes are held against those, spheres against boxes.
TEST(Elements, SpheresLoseNothingThatBoxesFind) {
  const int rays = scaled(4000);
  std::size_t hits = 0;
  for (const float scale : {1.0f, 1e-30f, 1e12f}) {
    for (const BuiltinScene builtin : {BuiltinScene::kTerrain, BuiltinScene::kSliver, BuiltinScene::kInstances}) {
      scene::Scene scene = small_builtin(builtin, 2000, 40);
      for (scene::Mesh& mesh : scene.meshes)
        for (Vec3& p : mesh.positions) p *= scale;
      for (scene::Instance& instance : scene.instances) instance.world_from_model.translation *= scale;
      const Accel boxes = build_with(scene, Elements::kBoxes, 0), spheres = build_with(scene, Elements::kSpheres, 0);
      RayBatch batch = mixed_rays(scene, static_cast<std::size_t>(rays), run_seed() + 5);
      Random random(run_seed());
      for (std::size_t i = 0; i < batch.size(); i += 5) {  // from afar, aimed as well as floats can
        Ray& ray = batch[i].ray;
        const float away = std::exp2(random.uniform(0, 16));
        const Vec3 target = ray.origin + ray.direction;
        ray.origin = target - away * ray.direction;
        ray.direction = target - ray.origin;
        if (ray.direction == Vec3{0}) ray.direction.x = 1;
      }
      const HitBatch expected = trace(boxes, batch), got = trace(spheres, batch);
      for (std::size_t i = 0; i < batch.size(); ++i) {
        ASSERT_TRUE(same_result(expected[i], got[i]))
            << "ray " << i << " of " << enum_name(builtin) << " scale " << scale << " seed " << run_seed()
            << std::hexfloat << " o " << batch[i].ray.origin.x << ' ' << batch[i].ray.origin.y << ' '
            << batch[i].ray.origin.z << " d " << batch[i].ray.direction.x << ' ' << batch[i].ray.direction.y << ' '
            << batch[i].ray.direction.z << " from " << batch[i].ray.tmin << " to " << batch[i].ray.tmax << ": boxes "
            << expected[i].hit.t << ' ' << expected[i].hit.primitive << ", spheres " << got[i].hit.t << ' '
            << got[i].hit.primitive;
        hits += expected[i].hit.valid();
      }
    }
  }
  EXPECT_GT(hits, static_cast<std::size_t>(3 * rays));
}

TEST(Elements, SpheresHoldTheBoxesBelow) {
  const scene::Scene scene = small_builtin(BuiltinScene::kSpheres, 3000);
  const Accel accel = build_with(scene, Elements::kSpheres, 0);
  ASSERT_EQ(accel.spheres.size(), accel.nodes.size());
  for (std::size_t i = 0; i < accel.nodes.size(); ++i) {
    for (int lane = 0; lane < accel.nodes[i].count; ++lane) {
      const NodeRef child = accel.nodes[i].child[lane];
      if (child.kind() != NodeRef::Kind::kLeaf) continue;
      const NodeSpheres& s = accel.spheres[i];
      const DVec3 centre(s.centre[0][lane], s.centre[1][lane], s.centre[2][lane]);
      for (std::uint32_t t = 0; t < child.triangles(); ++t)
        for (const auto& v : accel.blocks[child.first_block() + t / 4].vertex)
          ASSERT_LE(glm::length(DVec3(v[0][t % 4], v[1][t % 4], v[2][t % 4]) - centre), s.radius[lane]);
    }
  }
}

TEST(Elements, MixedNodesSpareBoxesAndVisits) {
  const scene::Scene scene = small_builtin(BuiltinScene::kTerrain, 3000);
  const RayBatch rays = mixed_rays(scene, 2000, run_seed());
  IntersectionCounts plain, mixed;
  HitBatch hits;
  trace_depth_first(build_with(scene, Elements::kBoxes, 0), rays, hits, plain);
  trace_depth_first(build_with(scene, Elements::kBoxes, 2), rays, hits, mixed);
  EXPECT_LT(mixed.box, plain.box);
  EXPECT_GT(mixed.triangle, plain.triangle);
}

TEST(Elements, APlainCopyHasNothingButBoxes) {
  const scene::Scene scene = small_builtin(BuiltinScene::kTerrain, 1000);
  const Accel plain = plain_copy(build_with(scene, Elements::kSpheres, 3));
  EXPECT_TRUE(plain.spheres.empty());
  for (const Node& node : plain.nodes) EXPECT_EQ(node.direct, 0);
}

}  // namespace
}  // namespace carousel::accel
