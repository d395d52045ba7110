// Bounding spheres, oriented boxes and mixed nodes: the same hits as of every primitive tested in turn, whatever bounds
// them.
#include <cmath>
#include <iostream>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "accel/builders/bounding_spheres.h"
#include "accel/exact/dyadic.h"
#include "accel/planes/cull_planes.h"
#include "accel/structure/cull_plane.h"
#include "accel/structure/primitive_boxes.h"
#include "tests/accel/planes/plane_rays.h"
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

/// As the rules of the configuration have it.
bool bounds_oriented_boxes(const AccuracyConfig& accuracy) {
  return accuracy.box == BoxLevel::kConservative &&
         (accuracy.triangle == TriangleLevel::kWatertight || accuracy.triangle == TriangleLevel::kExact);
}

TEST(Elements, GiveOneAnswer) {
  const HashedStop stop(0.4);
  for (const BuiltinScene builtin :
       {BuiltinScene::kSpheres, BuiltinScene::kTerrain, BuiltinScene::kInstances, BuiltinScene::kSliver}) {
    const scene::Scene scene = passing_scene(builtin, 12, run_seed());
    const BruteForceAnswers brute(scene, wishing_rays(scene, 1200, run_seed() + 1), {}, &stop);
    for (const Elements elements : {Elements::kBoxes, Elements::kSpheres, Elements::kOrientedBoxes}) {
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
    for (const Elements elements : {Elements::kBoxes, Elements::kSpheres, Elements::kOrientedBoxes}) {
      if (elements == Elements::kOrientedBoxes && !bounds_oriented_boxes(accuracy)) continue;
      const Accel accel = build_with(scene, elements, 2, 8, accuracy);
      for (const SimdTarget target : usable_simd_targets()) {
        const SimdGuard guard;
        select_simd_target(target);
        EXPECT_EQ(brute.differences(accel), 0u) << text(accuracy) << ' ' << enum_name(elements);
      }
    }
  }
}

// Far more rays than every primitive could be tested with: boxes are held against those, other elements against boxes.
TEST(Elements, LoseNothingThatBoxesFind) {
  const int rays = scaled(4000);
  std::size_t hits = 0;
  for (const float scale : {1.0f, 1e-30f, 1e12f}) {
    for (const BuiltinScene builtin : {BuiltinScene::kTerrain, BuiltinScene::kSliver, BuiltinScene::kInstances}) {
      scene::Scene scene = small_builtin(builtin, 2000, 40);
      for (scene::Mesh& mesh : scene.meshes)
        for (Vec3& p : mesh.positions) p *= scale;
      for (scene::Instance& instance : scene.instances) instance.world_from_model.translation *= scale;
      const Accel boxes = build_with(scene, Elements::kBoxes, 0);
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
      const HitBatch expected = trace(boxes, batch);
      for (const Elements elements : {Elements::kSpheres, Elements::kOrientedBoxes}) {
        const HitBatch got = trace(build_with(scene, elements, 0), batch);
        for (std::size_t i = 0; i < batch.size(); ++i) {
          ASSERT_TRUE(same_result(expected[i], got[i]))
              << "ray " << i << " of " << enum_name(builtin) << " scale " << scale << " seed " << run_seed()
              << std::hexfloat << " o " << batch[i].ray.origin.x << ' ' << batch[i].ray.origin.y << ' '
              << batch[i].ray.origin.z << " d " << batch[i].ray.direction.x << ' ' << batch[i].ray.direction.y << ' '
              << batch[i].ray.direction.z << " from " << batch[i].ray.tmin << " to " << batch[i].ray.tmax << ": boxes "
              << expected[i].hit.t << ' ' << expected[i].hit.primitive << ", " << enum_name(elements) << ' '
              << got[i].hit.t << ' ' << got[i].hit.primitive;
          hits += expected[i].hit.valid();
        }
      }
    }
  }
  EXPECT_GT(hits, static_cast<std::size_t>(6 * rays));
}

TEST(Elements, SpheresHoldTheBoxesBelow) {
  const scene::Scene scene = small_builtin(BuiltinScene::kSpheres, 3000);
  const Accel accel = build_with(scene, Elements::kSpheres, 0);
  ASSERT_EQ(accel.elements.spheres.size(), accel.nodes.size());
  for (std::size_t i = 0; i < accel.nodes.size(); ++i) {
    for (int lane = 0; lane < accel.nodes[i].count; ++lane) {
      const NodeRef child = accel.nodes[i].child[lane];
      if (child.kind() != NodeRef::Kind::kLeaf) continue;
      const NodeSpheres& s = accel.elements.spheres[i];
      const DVec3 centre(s.centre[0][lane], s.centre[1][lane], s.centre[2][lane]);
      for (std::uint32_t t = 0; t < child.triangles(); ++t)
        for (const auto& v : accel.blocks[child.first_block() + t / 4].vertex)
          ASSERT_LE(glm::length(DVec3(v[0][t % 4], v[1][t % 4], v[2][t % 4]) - centre), s.radius[lane]);
    }
  }
}

// In exact arithmetic: no vertex, and no corner of a triangle's box, is out of the boxes around them.
TEST(Elements, OrientedBoxesHoldWhatIsBelow) {
  std::size_t turned = 0, corners = 0;
  for (const Vec3& at : {Vec3(0), Vec3(1e5f, -3e4f, 1)}) {
    const Accel accel = build_with(icosphere_scene(3, at), Elements::kOrientedBoxes, 0);
    ASSERT_EQ(accel.elements.oriented_boxes.size(), accel.nodes.size());
    for (std::size_t i = 0; i < accel.nodes.size(); ++i) {
      const NodeOrientedBoxes& boxes = accel.elements.oriented_boxes[i];
      for (int lane = 0; lane < accel.nodes[i].count; ++lane) {
        const NodeRef leaf = accel.nodes[i].child[lane];
        for (int k = 0; k < 3; ++k) {
          const auto normal = [&](int which) {
            return DVec3(boxes.normal[which][0][lane], boxes.normal[which][1][lane], boxes.normal[which][2][lane]);
          };
          const auto holds = [&](const Vec3& p, float lo, float hi) {
            Dyadic along;
            for (int axis = 0; axis < 3; ++axis) along = along + Dyadic(boxes.normal[k][axis][lane]) * Dyadic(p[axis]);
            return (along - Dyadic(lo)).sign() >= 0 && (along - Dyadic(hi)).sign() <= 0;
          };
          EXPECT_LE(std::fabs(normal(k).x) + std::fabs(normal(k).y) + std::fabs(normal(k).z), 1);
          EXPECT_GE(glm::length(normal(k)), 0.577);
          EXPECT_NEAR(glm::dot(normal(k), normal((k + 1) % 3)), 0, 1e-6);
          turned += normal(k).x != 0 && normal(k).y != 0;
          if (leaf.kind() != NodeRef::Kind::kLeaf) continue;
          for (std::uint32_t t = 0; t < leaf.triangles(); ++t) {
            for (const Vec3& p : triangle_corners(accel, leaf, t))
              ASSERT_TRUE(holds(p, boxes.lo[k][lane], boxes.hi[k][lane]));
            const Aabb box = primitive_box(accel, leaf, t);
            for (int corner = 0; corner < 8; ++corner, ++corners)
              ASSERT_TRUE(holds({corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                                 corner & 4 ? box.hi.z : box.lo.z},
                                boxes.box_lo[k][lane], boxes.box_hi[k][lane]));
          }
        }
      }
    }
  }
  EXPECT_GT(turned, 100u);
  EXPECT_GT(corners, 10000u);
}

/// Rays at edges to an ulp, in the planes of triangles and along axes, at triangles that fill little of their boxes: no
/// other element holds a ray up where there is one triangle a leaf.
TEST(Elements, OrientedBoxesLoseNoGrazingRay) {
  const std::vector<scene::Scene> scenes{icosphere_scene(3),
                                         icosphere_scene(3, Vec3(1e6f, -1e6f, 1e6f), 20),
                                         icosphere_scene(2, Vec3(1e-9f, 0, 0), 1e-8f),
                                         small_builtin(BuiltinScene::kSliver, 1000),
                                         small_builtin(BuiltinScene::kTerrain, 2000),
                                         small_builtin(BuiltinScene::kInstances, 0, 12)};
  std::size_t hits = 0, lost = 0;
  for (const TriangleLevel level : {TriangleLevel::kWatertight, TriangleLevel::kExact}) {
    const std::size_t rays = static_cast<std::size_t>(scaled(level == TriangleLevel::kExact ? 2000 : 20000));
    AccuracyConfig accuracy;
    accuracy.triangle = level;
    BvhConfig bvh;
    bvh.leaf_triangles = 1;
    for (const scene::Scene& scene : scenes) {
      bvh.elements = Elements::kBoxes;
      const Accel boxes = build(scene, bvh, *make_sequential_executor(), accuracy);
      bvh.elements = Elements::kOrientedBoxes;
      const Accel turned = build(scene, bvh, *make_sequential_executor(), accuracy);
      const RayBatch batch = plane_grazing_rays(scene, rays, run_seed());
      const HitBatch expected = trace(boxes, batch), got = trace(turned, batch);
      for (std::size_t i = 0; i < batch.size(); ++i) {
        hits += expected[i].hit.valid();
        lost += !same_result(expected[i], got[i]);
      }
    }
  }
  std::cout << hits << " hits, " << lost << " lost, CAROUSEL_SEED=" << run_seed() << '\n';
  EXPECT_EQ(lost, 0u);
  EXPECT_GT(hits, static_cast<std::size_t>(scaled(50000)));
}

// Thin triangles across the axes, which fill little of their boxes.
TEST(Elements, OrientedBoxesAreMetLessOften) {
  const scene::Scene scene = small_builtin(BuiltinScene::kSliver, 3000);
  const RayBatch rays = mixed_rays(scene, 2000, run_seed());
  IntersectionCounts boxes, turned;
  HitBatch hits;
  trace_depth_first(build_with(scene, Elements::kBoxes, 0), rays, hits, boxes);
  trace_depth_first(build_with(scene, Elements::kOrientedBoxes, 0), rays, hits, turned);
  std::cout << "triangle tests: boxes " << boxes.triangle << ", oriented boxes " << turned.triangle << '\n';
  EXPECT_LT(turned.triangle, boxes.triangle);
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
  EXPECT_TRUE(plain.elements.empty());
  for (const Node& node : plain.nodes) EXPECT_EQ(node.direct, 0);
}

}  // namespace
}  // namespace carousel::accel
