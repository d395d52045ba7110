// Settings of bundles whose effect shows in counts: bundles below instances, wide bundles, the least storage.
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "accel/builders/build.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/ringbus/support/test_machine.h"

namespace carousel::ringbus {
namespace {

using Order = BundlesConfig::Order;

/// A grid of rays down onto a scene, hardly spread.
class Beam final : public Workload {
 public:
  Beam(const Aabb& bounds, std::uint32_t side) : bounds_(bounds), side_(side) {}
  Generated generate(WorkerId, std::size_t max_rays, RayBatch& out) override {
    const std::lock_guard lock(mutex_);
    std::size_t made = 0;
    for (; made < max_rays && next_ < side_ * side_; ++made, ++next_) {
      const auto at = [&](std::uint32_t i) { return (static_cast<float>(i) + 0.5f) / static_cast<float>(side_); };
      const Vec3 e = bounds_.extent();
      RayRequest ray;
      ray.ray.origin = bounds_.lo + Vec3{e.x * at(next_ % side_), 2 * e.y, e.z * at(next_ / side_)};
      ray.ray.direction = {1e-3f * at(next_ % 7), -1, 1e-3f};
      ray.tag.path = next_;
      out.push_back(ray);
    }
    return {made, next_ == side_ * side_};
  }
  void shade(WorkerId, const HitBatch& completed, RayBatch&) override {
    const std::lock_guard lock(mutex_);
    for (const RayResult& r : completed) digest_.add(hit_term(r.tag.path, 0, r.tag, r.hit));
  }
  HitsDigest digest() const { return digest_; }

 private:
  Aabb bounds_;
  std::uint32_t side_, next_ = 0;
  std::mutex mutex_;
  HitsDigest digest_;
};

struct BeamCounts {
  BundleCounts bundles;
  IntersectionCounts tests;
};

/// The work of a beam of rays in bundles, whose hits have to be the reference tracer's.
BeamCounts trace_beam(const scene::Scene& scene, const BundlesConfig& bundles, EngineKind engine) {
  Config config;
  config.engine.kind = engine;
  config.bundles = bundles;
  const accel::Accel accel = accel::build(scene, config.bvh, *make_sequential_executor());
  const float scene_size = glm::length(scene.bounds().extent());
  Beam beam(scene.bounds(), 64), reference(scene.bounds(), 64);
  const RunResult result =
      (engine == EngineKind::kCycle ? run_cycle : run_native)(config, accel, scene_size, beam, on_threads(1));
  accel::run_reference(accel, reference);
  EXPECT_EQ(beam.digest().hex(), reference.digest().hex());
  BeamCounts counts;
  for (const ResourceStatistics& r : result.resources) {
    for (const BundleCounts& at_depth : r.bundles) counts.bundles += at_depth;
    counts.tests += r.tests;
  }
  return counts;
}

/// The boxes that bundles of a beam settle.
std::uint64_t settled_in_beam(const scene::Scene& scene, const BundlesConfig& bundles, EngineKind engine) {
  const BundleCounts counts = trace_beam(scene, bundles, engine).bundles;
  return counts.all + counts.none;
}

/// The boxes that bundles of scattered rays settle.
std::uint64_t settled(TestScene& scene, const BundlesConfig& bundles, EngineKind engine) {
  Cell cell;
  cell.config.engine.kind = engine;
  cell.config.bundles = bundles;
  const Outcome outcome = run_cell(scene, cell);
  EXPECT_EQ(outcome.fault, "");
  std::uint64_t lanes = 0;
  for (const BundleCounts& at_depth : outcome.sum.bundles) lanes += at_depth.all + at_depth.none;
  return lanes;
}

TEST(BundleMachines, RaysMayStayTogetherBelowInstances) {
  scene::Scene scene = accel::icosphere_scene(4);
  scene.instances[0].world_from_model = {Mat3(Vec3{2, 0.3f, 0}, Vec3{0, 1, 0.2f}, Vec3{-0.1f, 0, 3}), {1, 2, 3}};
  BundlesConfig bundles;
  bundles.size = 8;
  bundles.builder.threshold = 0.2;
  for (const EngineKind engine : {EngineKind::kNative, EngineKind::kCycle}) {
    bundles.at_instances = BundlesConfig::AtInstances::kSplit;
    const std::uint64_t above = settled_in_beam(scene, bundles, engine);
    bundles.at_instances = BundlesConfig::AtInstances::kRebound;
    EXPECT_GT(settled_in_beam(scene, bundles, engine), 2 * above) << enum_name(engine);
  }
}

TEST(BundleMachines, RaysMissThePrimitivesThatTheirBundleMisses) {
  const scene::Scene scene = builtin_scene(BuiltinScene::kTerrain, 3000, 0);
  BundlesConfig bundles;
  bundles.size = 8;
  bundles.order = Order::kAnyHitOnly;  // takes bundles down to the leaves
  bundles.builder.threshold = 0.2;
  for (const EngineKind engine : {EngineKind::kNative, EngineKind::kCycle}) {
    bundles.leaf = BundlesConfig::Leaf::kRays;
    const BeamCounts rays = trace_beam(scene, bundles, engine);
    EXPECT_EQ(rays.bundles.leaf_tests, 0u);
    bundles.leaf = BundlesConfig::Leaf::kPrimitives;
    const BeamCounts leaf = trace_beam(scene, bundles, engine);
    EXPECT_GT(leaf.bundles.leaf_misses, leaf.bundles.leaf_tests / 20);
    EXPECT_GE(leaf.bundles.leaf_tests_spared, leaf.bundles.leaf_misses);
    // Hits shorten rays in another order: the tests are the same but for a few.
    const auto expected = static_cast<double>(rays.tests.triangle - leaf.bundles.leaf_tests_spared);
    EXPECT_NEAR(static_cast<double>(leaf.tests.triangle), expected, 0.02 * expected) << enum_name(engine);
  }
}

TEST(BundleMachines, UndecidedBundlesComeBackInSmallerOnes) {
  const scene::Scene scene = builtin_scene(BuiltinScene::kTerrain, 3000, 0);
  BundlesConfig bundles;
  bundles.size = 8;
  bundles.builder.threshold = 0.2;
  for (const EngineKind engine : {EngineKind::kNative, EngineKind::kCycle}) {
    bundles.split = BundlesConfig::Split::kBuilder;
    const BeamCounts builder = trace_beam(scene, bundles, engine);
    bundles.split = BundlesConfig::Split::kUntested;
    const BeamCounts untested = trace_beam(scene, bundles, engine);
    EXPECT_EQ(builder.bundles.returned, 0u);
    EXPECT_GT(untested.bundles.returned, 100u);
    EXPECT_EQ(untested.bundles.split, 0u) << "a ray of a bundle was tested after all";
    EXPECT_GT(untested.tests.bundle, builder.tests.bundle);
  }
}

TEST(BundleMachines, WideBundlesSplit) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 1000, 0);
  BundlesConfig bundles;
  bundles.size = 8;
  bundles.builder.threshold = 0.5;
  const std::uint64_t all = settled(scene, bundles, EngineKind::kNative);
  bundles.split_above.spread = 0.1;
  const std::uint64_t narrow = settled(scene, bundles, EngineKind::kNative);
  EXPECT_LT(narrow, all);
  bundles.split_above = {0, 1e9};
  EXPECT_EQ(settled(scene, bundles, EngineKind::kNative), all);
  bundles.split_above = {0, 0.05};
  EXPECT_LT(settled(scene, bundles, EngineKind::kNative), all);
  bundles.split_above = {1e-6, 0};
  EXPECT_LT(settled(scene, bundles, EngineKind::kNative), narrow);
}

// A bundle that splits joins collections with many IDs at once, for which the reserve must have room.
TEST(BundleMachines, TheLeastStorageIsEnough) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 2000, 2);
  std::uint64_t reserves = 0, split = 0;
  for (const std::int64_t size : {2, 8, 32}) {
    for (const Order order : {Order::kAllHitFirst, Order::kAnyHitOnly, Order::kParallel}) {
      if (order == Order::kParallel && size != 8) continue;
      Cell cell;
      Config& c = cell.config;
      c.topology.resources = 2;
      c.rays.slots_per_resource = 4096;
      c.packets.rays = 1;
      c.collections.ready = 4;
      c.collections.policy = Policy::kOldest;  // breadth first fills it
      c.bundles.size = size;
      c.bundles.order = order;
      c.bundles.builder.threshold = 100;
      c.bundles.builder.same_signs = false;
      if (order == Order::kParallel) c.bundles.split = BundlesConfig::Split::kUntested;
      cell.tight_storage = true;
      const Outcome outcome = run_cell(scene, cell);
      EXPECT_EQ(outcome.fault, "") << cell.text();
      reserves += outcome.sum.stalls[StallReason::kReserve];
      for (const BundleCounts& at_depth : outcome.sum.bundles) split += at_depth.split;
    }
  }
  EXPECT_GT(reserves, 0u) << "storage was never short";
  EXPECT_GT(split, 100u);
}

}  // namespace
}  // namespace carousel::ringbus
