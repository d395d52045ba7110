// Counts of cull planes are right by depth and in either order of planes and box.
#include <cstring>

#include <gtest/gtest.h>

#include "accel/planes/cull_planes.h"
#include "accel/traverse/kernels.h"
#include "accel/traverse/ray_check.h"
#include "core/config/config.h"
#include "core/statistics/cull_counts.h"
#include "core/types/enum_names.h"
#include "tests/accel/planes/plane_rays.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/simd_guard.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

using Nodes = CullPlanesConfig::Nodes;
using PlaneOrder = CullPlanesConfig::Order;

Accel with_planes(const scene::Scene& scene, const CullPlanesConfig& planes) {
  return build(scene, {}, *make_sequential_executor(), {}, planes);
}

struct Traced {
  std::vector<RayRecord> records;
  IntersectionCounts tests;
  CullCounts culls;
};

Traced traced(const Accel& accel, const RayBatch& rays, decltype(trace_subtree)& trace = trace_subtree) {
  Traced out;
  for (const RayRequest& request : rays) start_record(request, out.records.emplace_back());
  trace(accel, accel.root_key(), {out.records.data(), nullptr, out.records.size(), &out.culls}, out.tests);
  return out;
}

TEST(CullPlaneCounts, ComeByDepth) {
  const scene::Scene scene = small_builtin(BuiltinScene::kTerrain, 5000);
  const Accel all = with_planes(scene, {.count = 2, .nodes = Nodes::kAll});
  const RayBatch rays = whole_rays(scene, 5000, run_seed());
  std::vector<std::size_t> depths(all.nodes.size(), 0);
  std::size_t deepest = 0;
  for (std::size_t i = 0; i < all.nodes.size(); ++i) {
    EXPECT_EQ(all.nodes[i].depth, depths[i]);
    deepest = std::max(deepest, depths[i]);
    for (int lane = 0; lane < all.nodes[i].count; ++lane)
      if (all.nodes[i].child[lane].is_inner()) depths[all.nodes[i].child[lane].node()] = depths[i] + 1;
  }
  ASSERT_GE(deepest, 3u);
  for (std::size_t depth = 0; depth <= deepest; ++depth) {
    Accel one = all;
    for (std::size_t i = 0; i < one.nodes.size(); ++i)
      if (depths[i] != depth) one.nodes[i].plane_counts = 0;
    for (decltype(trace_subtree)* trace : {&trace_subtree, &trace_interleaved}) {
      const Traced run = traced(one, rays, *trace);
      EXPECT_GT(run.culls.below[depth].children, 20u);
      EXPECT_EQ(run.culls.below[depth], run.culls.sum()) << "depth " << depth;
      EXPECT_EQ(run.culls.sum().plane_tests, run.tests.plane);
      EXPECT_EQ(run.culls.sum().culled(), run.tests.culled);
    }
  }
}

// Rays that hit nothing are spared nothing by a closer hit: what is counted is the difference to the test.
TEST(CullPlaneCounts, AreTheDifferenceForRaysThatHitNothing) {
  for (const BuiltinScene builtin : {BuiltinScene::kTerrain, BuiltinScene::kSpheres, BuiltinScene::kInstances}) {
    const scene::Scene scene = small_builtin(builtin, 3000, 20);
    const Accel plain = build_sequential(scene);
    RayBatch rays;
    const RayBatch all = plane_grazing_rays(scene, 4000, run_seed());
    const Traced found = traced(plain, all);
    for (std::size_t i = 0; i < all.size(); ++i)
      if (!found.records[i].hit.valid()) rays.push_back(all[i]);
    ASSERT_GT(rays.size(), 500u);
    const Traced without = traced(plain, rays);
    const Traced with = traced(with_planes(scene, {.count = 3, .nodes = Nodes::kLeaves}), rays);
    const CullLevel sum = with.culls.sum();
    EXPECT_GT(sum.leaves, 50u);
    EXPECT_EQ(sum.nodes + sum.instances, 0u);
    EXPECT_EQ(without.tests.triangle - with.tests.triangle, sum.triangles) << int(builtin);
    EXPECT_EQ(without.tests.box, with.tests.box);

    // A node that is not visited spares its boxes and all below.
    const Traced inner = traced(with_planes(scene, {.count = 3, .nodes = Nodes::kInner}), rays);
    EXPECT_EQ(inner.culls.sum().leaves, 0u);
    EXPECT_GE(without.tests.box - inner.tests.box, 2 * inner.culls.sum().nodes) << int(builtin);
  }
}

TEST(CullPlaneCounts, OfPlanesFirstDifferInTestsOnly) {
  std::uint64_t spared = 0;
  for (const BuiltinScene builtin : {BuiltinScene::kTerrain, BuiltinScene::kSliver, BuiltinScene::kInstances}) {
    const scene::Scene scene = small_builtin(builtin, 1000, 20);
    const RayBatch rays = plane_grazing_rays(scene, 1500, run_seed());
    for (const std::int64_t count : {1, 2, 8})
      for (const bool shared : {false, true}) {
        CullPlanesConfig planes{.count = count, .nodes = Nodes::kAll, .shared_normals = shared};
        const Traced box_first = traced(with_planes(scene, planes), rays);
        planes.order = PlaneOrder::kPlanesFirst;
        for (decltype(trace_subtree)* trace : {&trace_subtree, &trace_interleaved}) {
          const Traced planes_first = traced(with_planes(scene, planes), rays, *trace);
          for (std::size_t i = 0; i < rays.size(); ++i)
            ASSERT_EQ(std::memcmp(&planes_first.records[i].hit, &box_first.records[i].hit, sizeof(Hit)), 0)
                << int(builtin) << " ray " << i;
          const CullLevel first = planes_first.culls.sum(), after = box_first.culls.sum();
          EXPECT_EQ(planes_first.tests.culled, box_first.tests.culled) << int(builtin) << " planes " << count;
          EXPECT_EQ(planes_first.tests.triangle, box_first.tests.triangle);
          EXPECT_EQ(planes_first.tests.box + first.boxes, box_first.tests.box);
          EXPECT_GE(first.children, after.children);
          EXPECT_GE(planes_first.tests.plane, box_first.tests.plane);
          EXPECT_EQ(after.boxes, 0u);
          if (count == 8) {
            EXPECT_GT(first.boxes, 0u);
          }
          spared += first.boxes;
        }
      }
  }
  EXPECT_GT(spared, 1000u);
}

TEST(CullPlaneCounts, AreTheSameOnEverySimdTarget) {
  const std::vector<SimdTarget> targets = usable_simd_targets();
  const SimdGuard guard;
  std::size_t culled = 0;
  for (const PlaneOrder order : {PlaneOrder::kBoxFirst, PlaneOrder::kPlanesFirst})
    for (const bool shared : {false, true})
      for (const BuiltinScene builtin : {BuiltinScene::kTerrain, BuiltinScene::kInstances}) {
        const scene::Scene scene = small_builtin(builtin, 3000, 60);
        const RayBatch rays = plane_grazing_rays(scene, 5000, run_seed() + 3);
        const Accel accel = with_planes(scene, {.count = 5,
                                                .nodes = Nodes::kAll,
                                                .shared_normals = shared,
                                                .order = order,
                                                .levels = CullPlanesConfig::Levels::kAll});
        select_simd_target(targets.front());
        const Traced first = traced(accel, rays);
        culled += first.tests.culled;
        for (const SimdTarget target : targets) {
          select_simd_target(target);
          const Traced run = traced(accel, rays);
          EXPECT_EQ(run.tests, first.tests) << enum_name(target);
          EXPECT_EQ(run.culls, first.culls) << enum_name(target);
          for (std::size_t i = 0; i < rays.size(); ++i)
            ASSERT_EQ(std::memcmp(&run.records[i].hit, &first.records[i].hit, sizeof(Hit)), 0)
                << enum_name(target) << " ray " << i;
        }
      }
  EXPECT_GT(culled, 10000u);
}

TEST(CullPlaneCounts, AreNoneWithoutPlanes) {
  const scene::Scene scene = small_builtin(BuiltinScene::kTerrain, 3000);
  const RayBatch rays = plane_grazing_rays(scene, 2000, run_seed() + 4);
  const Accel accel = with_planes(scene, {.count = 4, .nodes = Nodes::kAll}), plain = plain_copy(accel);
  const Traced built_so = traced(build_sequential(scene), rays), taken_off = traced(plain, rays);
  EXPECT_EQ(taken_off.tests, built_so.tests);
  EXPECT_EQ(taken_off.culls, CullCounts{});
  EXPECT_EQ(plain.size_bytes(), build_sequential(scene).size_bytes());
  EXPECT_GT(traced(accel, rays).tests.culled, 100u);
}

// In a strip some lanes may be asked for: planes of others are not tested.
TEST(CullPlaneCounts, OfPlanesFirstAreOfTheLanesAskedFor) {
  const scene::Scene scene = small_builtin(BuiltinScene::kTerrain, 3000);
  const Accel accel = with_planes(scene, {.count = 4, .nodes = Nodes::kAll, .order = PlaneOrder::kPlanesFirst});
  const NodeKey root = accel.root_key();
  const Node& node = accel.nodes[root.ref.node()];
  ASSERT_GT(node.plane_counts, 0u);
  for (int lane = 0; lane < node.count; ++lane) {
    RayRecord record;
    start_record(whole_rays(scene, 1, run_seed())[0], record);
    std::uint8_t mask = 0;
    float nearest[kMaxWidth];
    std::fill(std::begin(nearest), std::end(nearest), kInfinity);
    IntersectionCounts counts;
    CullCounts culls;
    test_strip(accel, root, 1u << lane, {&record, nullptr, 1, &culls}, {&mask, nearest, nullptr}, counts);
    EXPECT_EQ(culls.sum().children, plane_count(node, lane) > 0 ? 1u : 0u);
    EXPECT_EQ(counts.box + culls.sum().boxes, 1u);
    EXPECT_LE(counts.plane, static_cast<std::uint64_t>(plane_count(node, lane)));
  }
}

}  // namespace
}  // namespace carousel::accel
