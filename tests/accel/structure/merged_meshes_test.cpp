// Meshes of the world that share one structure (`bvh.merge: world`): the same hits as of every primitive tested in
// turn, with the same names.
#include "accel/structure/merged_meshes.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "accel/traverse/exact_reference.h"
#include "tests/accel/structure/passing_scenes.h"
#include "tests/accel/traverse/brute_force_answers.h"
#include "tests/accel/traverse/levels.h"
#include "tests/support/random_runs.h"

namespace carousel::accel::merged_meshes_test {
namespace {

Accel build_with(const scene::Scene& scene, const BvhConfig& config, const AccuracyConfig& accuracy = {}) {
  return build(scene, config, *make_sequential_executor(), accuracy);
}

BvhConfig merging(std::int64_t width = 8) {
  BvhConfig config;
  config.merge = BvhConfig::Merge::kWorld;
  config.width = width;
  return config;
}

/// Meshes that stand in the world among instances with transforms and spheres. Each third triangle stands in two of the
/// meshes, so that hits tie; the mesh in the middle stands there twice, and is not merged.
scene::Scene overlapping(std::uint32_t meshes, std::uint64_t seed) {
  scene::Scene scene = passing_scene(BuiltinScene::kInstances, 6, seed);
  Random random(seed);
  const Aabb bounds = small_builtin(BuiltinScene::kSpheres, 250).bounds();
  std::vector<Vec3> before;
  for (std::uint32_t i = 0; i < meshes; ++i) {
    std::vector<Vec3> corners;
    for (std::uint32_t k = 0; k < 20; ++k) {
      const bool again = k % 3 == 0 && !before.empty();
      for (std::uint32_t c = 0; c < 3; ++c)
        corners.push_back(again ? before[3 * k + c] : random.in_box(bounds.lo, bounds.hi));
    }
    before = corners;
    add_instance(scene, add_mesh(scene, soup(corners)));
    if (i == meshes / 2) add_instance(scene, static_cast<std::uint32_t>(scene.meshes.size() - 1));
  }
  return scene;
}

TEST(MergedMeshes, NameTrianglesByTheirOwnMeshes) {
  MergedMeshes merged;
  EXPECT_FALSE(merged.holds(0));
  EXPECT_EQ(merged.instance(), kNoInstance);
  merged.add(2, 0);
  merged.add(5, 10);
  merged.add(6, 11);
  EXPECT_EQ(merged.instance(), 2u);
  EXPECT_TRUE(merged.holds(5));
  EXPECT_FALSE(merged.holds(3));
  const auto expect = [&](std::uint32_t number, std::uint32_t instance, std::uint32_t primitive) {
    EXPECT_EQ(merged.name(number).instance, instance) << number;
    EXPECT_EQ(merged.name(number).primitive, primitive) << number;
  };
  expect(0, 2, 0);
  expect(9, 2, 9);
  expect(10, 5, 0);
  expect(11, 6, 0);
  expect(40, 6, 29);
}

TEST(MergedMeshes, AreThoseThatStandInTheWorldOnce) {
  const scene::Scene scene = overlapping(7, run_seed());
  const Accel accel = build_with(scene, merging());
  std::vector<std::uint32_t> uses(scene.meshes.size());
  for (const scene::Instance& instance : scene.instances) ++uses[instance.mesh.value];
  std::size_t expected = 0, triangles = 0;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Instance& instance = scene.instances[i];
    const scene::Mesh& mesh = scene.meshes[instance.mesh.value];
    const scene::Affine& m = instance.world_from_model;
    const bool stands = m.linear == Mat3(1.0f) && m.translation == Vec3(0.0f);
    const bool merged = stands && uses[instance.mesh.value] == 1 && mesh.spheres.empty();
    EXPECT_EQ(accel.merged.holds(i), merged) << i;
    expected += merged;
    if (merged) triangles += mesh.triangle_count();
  }
  EXPECT_GE(expected, 6u);
  EXPECT_EQ(accel.merged.count(), expected);
  EXPECT_EQ(accel.instances[accel.merged.instance()].triangles, triangles);
  EXPECT_EQ(build_with(scene, {}).merged.count(), 0u);
}

/// The children of the top level: instances, and nodes or leaves of the merged meshes with the areas of their boxes.
struct Top {
  std::size_t instances = 0;
  std::vector<std::pair<NodeRef, float>> hung;
};
Top top_of(const Accel& accel) {
  Top out;
  std::vector<NodeRef> open{accel.root_key().ref};
  while (!open.empty()) {
    const Node& node = accel.nodes[open.back().node()];
    open.pop_back();
    EXPECT_TRUE(node.above_instances);
    for (int lane = 0; lane < node.count; ++lane) {
      const NodeRef child = node.child[lane];
      if (child.is_instance()) {
        EXPECT_FALSE(accel.merged.holds(child.instance_index()));
        ++out.instances;
      } else if (child.is_inner() && accel.nodes[child.node()].above_instances) {
        open.push_back(child);
      } else {
        Aabb box;
        for (int axis = 0; axis < 3; ++axis)
          box.lo[axis] = node.plane[axis][lane], box.hi[axis] = node.plane[axis + 3][lane];
        out.hung.emplace_back(child, box.half_area());
      }
    }
  }
  return out;
}

// Nodes and leaves in the frame of the world stand beside instances in the top level (US 12394134, paragraph 8), as
// many as divide it well.
TEST(MergedMeshes, HangInTheTopLevelBesideInstances) {
  const scene::Scene scene = overlapping(9, run_seed());
  const Accel accel = build_with(scene, merging());
  const Top top = top_of(accel);
  EXPECT_GE(top.instances, 6u);
  EXPECT_GE(top.hung.size(), 2 * top.instances);
  EXPECT_LT(top.hung.size(), 2 * top.instances + kMaxWidth);
  // Opened are the largest: none that hangs there is larger than all that were opened, one of which is the root.
  std::size_t triangles = 0;
  float largest = 0, all = 0;
  for (const auto& [ref, area] : top.hung) {
    triangles += ref.is_inner() ? accel.nodes[ref.node()].triangles : ref.triangles();
    if (ref.is_inner()) largest = std::max(largest, area);
    all = std::max(all, area);
  }
  EXPECT_EQ(triangles, accel.instances[accel.merged.instance()].triangles);
  EXPECT_GT(all, 0.0f);
  std::size_t larger = 0;  // inner nodes of the merged structure that would have been opened before it
  std::vector<NodeRef> open{accel.instances[accel.merged.instance()].root};
  while (!open.empty()) {
    const NodeRef ref = open.back();
    open.pop_back();
    if (std::any_of(top.hung.begin(), top.hung.end(), [&](const auto& one) { return one.first == ref; })) continue;
    ASSERT_TRUE(ref.is_inner());
    const Node& node = accel.nodes[ref.node()];
    Aabb box;
    for (int lane = 0; lane < node.count; ++lane) {
      for (int axis = 0; axis < 3; ++axis)
        box.extend(Vec3{node.plane[0][lane], node.plane[1][lane], node.plane[2][lane]}),
            box.extend(Vec3{node.plane[3][lane], node.plane[4][lane], node.plane[5][lane]});
      open.push_back(node.child[lane]);
    }
    EXPECT_GE(box.half_area(), largest);
    ++larger;
  }
  EXPECT_GE(larger, 2u);
}

// Alone in the world they are the structure, and rays begin at its root.
TEST(MergedMeshes, AloneAreTheWholeStructure) {
  scene::Scene scene = empty_scene();
  Random random(run_seed());
  for (int i = 0; i < 3; ++i) {
    std::vector<Vec3> corners;
    for (int k = 0; k < 60; ++k) corners.push_back(random.in_box(Vec3{-1}, Vec3{1}));
    add_instance(scene, add_mesh(scene, soup(corners)));
  }
  const Accel accel = build_with(scene, merging());
  EXPECT_EQ(accel.root_key(), (NodeKey{kNoInstance, accel.instances[0].root}));
  EXPECT_FALSE(accel.nodes[accel.root_key().ref.node()].above_instances);
  const BruteForceAnswers brute(scene, mixed_rays(scene, 300, run_seed()), {});
  EXPECT_EQ(brute.differences(accel), 0u);
  EXPECT_GT(brute.hits(), 50u);
}

TEST(MergedMeshes, GiveOneAnswer) {
  const HashedStop stop(0.4);
  const scene::Scene scene = overlapping(9, run_seed());
  const BruteForceAnswers brute(scene, wishing_rays(scene, 500, run_seed() + 1), {}, &stop);
  for (const auto elements : {BvhConfig::Elements::kBoxes, BvhConfig::Elements::kSpheres}) {
    for (const std::int64_t direct : {0, 4}) {
      for (const std::int64_t width : {2, 8}) {
        BvhConfig config = merging(width);
        config.elements = elements;
        config.top_triangles = config.mixed_triangles = direct;
        config.quality = width == 2 ? BvhConfig::Quality::kHigh : BvhConfig::Quality::kFast;
        Accel accel = build_with(scene, config);
        accel.any_hit = &stop;
        EXPECT_EQ(brute.differences(accel), 0u) << enum_name(elements) << " direct " << direct << " width " << width;
      }
    }
  }
  EXPECT_GT(brute.hits(), 100u);
}

TEST(MergedMeshes, GiveOneAnswerAtEveryLevel) {
  const scene::Scene scene = overlapping(6, run_seed());
  const RayBatch rays = mixed_rays(scene, 50, run_seed());
  for (const AccuracyConfig& accuracy : triangle_and_box_levels())
    EXPECT_EQ(BruteForceAnswers(scene, rays, accuracy).differences(build_with(scene, merging(), accuracy)), 0u)
        << text(accuracy);
}

TEST(MergedMeshes, AgreeWithTheExactReference) {
  const scene::Scene scene = overlapping(6, run_seed());
  AccuracyConfig accuracy;
  accuracy.triangle = TriangleLevel::kExact;
  accuracy.box = BoxLevel::kDouble;
  const Accel merged = build_with(scene, merging(), accuracy);
  const ExactReference reference(scene);
  const RayBatch rays = mixed_rays(scene, 1200, run_seed());
  int hits = 0;
  for (std::size_t i = 0; i < rays.size(); i += 6) {  // every sixth ray is aimed at no edge
    const ExactHit exact = reference.closest(rays[i].ray);
    if (!exact.hit.valid() || !merged.merged.holds(exact.hit.instance)) continue;
    RayRequest ray = rays[i];
    ray.tag.kind = RayKind::kCamera;
    const Hit hit = trace_one(merged, ray);
    ++hits;
    EXPECT_EQ(hit.instance, exact.hit.instance);
    EXPECT_EQ(hit.primitive, exact.hit.primitive);
    EXPECT_EQ(float(exact.t), exact.hit.t);
  }
  EXPECT_GT(hits, 20);
}

// Merged structures are for meshes that overlap, among which they spare boxes.
TEST(MergedMeshes, SpareBoxes) {
  const scene::Scene scene = overlapping(12, run_seed());
  const RayBatch rays = mixed_rays(scene, 1000, run_seed());
  IntersectionCounts apart, merged;
  HitBatch hits;
  trace_depth_first(build_with(scene, {}), rays, hits, apart);
  trace_depth_first(build_with(scene, merging()), rays, hits, merged);
  EXPECT_LT(merged.box, apart.box);
}

}  // namespace
}  // namespace carousel::accel::merged_meshes_test
