// Settings of bundles whose effect shows in counts: bundles below instances, wide bundles, the least storage.
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "accel/build/build.h"
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

/// The boxes that bundles of a beam settle.
std::uint64_t settled_in_beam(const scene::Scene& scene, const BundlesConfig& bundles, EngineKind engine) {
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
  std::uint64_t lanes = 0;
  for (const ResourceStatistics& r : result.resources)
    for (const BundleCounts& at_depth : r.bundles) lanes += at_depth.all + at_depth.none;
  return lanes;
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
    for (const Order order : {Order::kAllHitFirst, Order::kAnyHitOnly}) {
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
