// Faults in a whole machine: they cost time and change no hit.
#include <gtest/gtest.h>

#include "ringbus/native_engine.h"
#include "tests/ringbus/test_machine.h"

namespace carousel::ringbus {
namespace {

// Hits and picture do not notice, on either engine, whatever fails.
TEST(FaultIdentity, FaultsCostTimeAndChangeNoHit) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 1000, 0), 300, 2);
  for (const EngineKind engine : {EngineKind::kNative, EngineKind::kCycle})
    for (int fault = 0; fault < 4; ++fault) {
      SCOPED_TRACE(testing::Message() << "engine " << static_cast<int>(engine) << " fault " << fault);
      Cell cell;
      Config& c = cell.config;
      c.engine.kind = engine;
      cell.threads = 2;
      c.topology.resources = 3;
      c.topology.link.depth = 4;
      c.rays.slots_per_resource = 64;
      if (fault == 0) c.faults.links = {0.05, 0.05, 0.05, 0.05, 0.05, 30};
      if (fault == 1) c.faults.links.drop = 0.3;
      if (fault == 2) c.faults.resource = {FaultsConfig::Resource::Kind::kPause, 1, 20, 50'000, 4};
      if (fault == 3) c.faults.resource = {FaultsConfig::Resource::Kind::kSlow, 2, 0, 1, 20};
      const auto outcome = run_cell(scene, cell);
      EXPECT_EQ(outcome.fault, "");
    }
}

/// A machine of `resources` of which one stops after some rays.
Cell with_a_stop(std::int64_t resources, std::int64_t number, std::int64_t after) {
  Cell cell;
  Config& c = cell.config;
  cell.threads = 2;
  c.topology.resources = resources;
  c.topology.link.depth = 4;
  c.rays.slots_per_resource = 64;
  c.faults.resource.kind = FaultsConfig::Resource::Kind::kStop;
  c.faults.resource.number = number;
  c.faults.resource.after_rays = after;
  return cell;
}

Outcome run_with_a_stop(TestScene& scene, Cell cell, ScatterWorkload& workload) {
  const accel::Accel& accel = scene.accel(cell.config.bvh, cell.config.cull_planes);
  cell.config.collections.capacity = 50 * minimum_capacity(cell.config, accel.width, accel.max_depth);
  RunOptions options;
  options.threads = cell.threads;
  Outcome out;
  try {
    out.result = run_native(cell.config, accel, scene.size(), workload, options);
  } catch (const std::exception& error) {
    out.fault = error.what();
  }
  return out;
}

TEST(StoppedResource, ItsRaysBeginAgainElsewhereAndNothingChanges) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 1000, 0), 400, 2);
  for (const Traversal traversal : {Traversal::kSpread, Traversal::kOrdered, Traversal::kTreelet})
    for (const TopologyShape shape : {TopologyShape::kRing, TopologyShape::kBidirectional, TopologyShape::kPointToPoint}) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(traversal) << " " << static_cast<int>(shape));
      Cell cell = with_a_stop(shape == TopologyShape::kRing ? 2 : 4, 1, 30);
      cell.config.collections.traversal = traversal;
      cell.config.topology.shape = shape;
      ScatterWorkload workload = scene.workload();
      const Outcome out = run_with_a_stop(scene, cell, workload);
      ASSERT_EQ(out.fault, "");
      EXPECT_TRUE(out.result.complete);
      EXPECT_GT(out.result.rays_restarted, 0u);
      EXPECT_GT(out.result.recovery_seconds, 0);
      EXPECT_EQ(workload.digest().hex(), scene.digest().hex());
      EXPECT_EQ(workload.rays(), scene.rays());
      EXPECT_EQ(workload.doubled(), 0u);
      EXPECT_EQ(out.result.rays_completed, out.result.rays_emitted);
    }
}

TEST(StoppedResource, OverFailingLinksToo) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 1000, 0), 200, 2);
  Cell cell = with_a_stop(3, 0, 10);
  cell.config.faults.links.drop = 0.1;
  cell.config.rays.placement = Placement::kRoundRobin;
  ScatterWorkload workload = scene.workload();
  const Outcome out = run_with_a_stop(scene, cell, workload);
  ASSERT_EQ(out.fault, "");
  EXPECT_GT(out.result.rays_restarted, 0u);
  EXPECT_EQ(workload.digest().hex(), scene.digest().hex());
}

TEST(StoppedResource, WithoutRecoveryTheRunSaysWhatIsMissing) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 1000, 0), 200, 1);
  Cell cell = with_a_stop(3, 2, 10);
  cell.config.faults.resource.recover = false;
  ScatterWorkload workload = scene.workload();
  const Outcome out = run_with_a_stop(scene, cell, workload);
  EXPECT_NE(out.fault.find("resource 2 stopped and faults.resource.recover is off: "), std::string::npos) << out.fault;
  EXPECT_NE(out.fault.find(" rays are missing, of paths "), std::string::npos) << out.fault;
}

}  // namespace
}  // namespace carousel::ringbus
