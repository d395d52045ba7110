// Faults in a whole machine: they cost time and change no hit.
#include <gtest/gtest.h>

#include "tests/accel/structure/passing_scenes.h"
#include "tests/ringbus/support/test_machine.h"

namespace carousel::ringbus {
namespace {

using FaultKind = FaultsConfig::Resource::Kind;

// Hits and picture do not notice, on either engine, whatever fails.
TEST(FaultIdentity, FaultsCostTimeAndChangeNoHit) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 1000, 0), 200, 2);
  for (const EngineKind engine : {EngineKind::kNative, EngineKind::kCycle})
    for (int fault = 0; fault < 4; ++fault) {
      SCOPED_TRACE(testing::Message() << "engine " << static_cast<int>(engine) << " fault " << fault);
      Cell cell;
      Config& c = cell.config;
      c.engine.kind = engine;
      // On a busy machine two threads lose a time slice a loss on a link, or a window: RandomFaults has some of these.
      cell.threads = engine == EngineKind::kNative && fault >= 2 ? 2 : 1;
      c.topology.resources = 3;
      c.topology.link.depth = 4;
      c.rays.slots_per_resource = 64;
      if (fault == 0) c.faults.links = {0.02, 0.02, 0.02, 0.02, 0.02, 30};
      if (fault == 1) c.faults.links.drop = 0.3;
      if (fault == 2) c.faults.resource = {FaultKind::kPause, 1, 20, 50'000, 4};
      if (fault == 3) c.faults.resource = {FaultKind::kSlow, 2, 0, 1, 20};
      const auto outcome = run_cell(scene, cell);
      EXPECT_EQ(outcome.fault, "");
    }
}

/// A machine of which one resource stops after some rays.
Cell with_a_stop(EngineKind engine, std::int64_t resources, std::int64_t number, std::int64_t after) {
  Cell cell;
  Config& c = cell.config;
  c.engine.kind = engine;
  cell.threads = engine == EngineKind::kNative ? 2 : 1;
  c.topology.resources = resources;
  c.topology.link.depth = 4;
  c.rays.slots_per_resource = 64;
  c.faults.resource.kind = FaultKind::kStop;
  c.faults.resource.number = number;
  c.faults.resource.after_rays = after;
  return cell;
}

/// As run_cell(), and with the machine's own way to begin again having been taken.
void expect_recovery(TestScene& scene, const Cell& cell) {
  const Outcome out = run_cell(scene, cell);
  EXPECT_EQ(out.fault, "");
  EXPECT_GT(out.result.rays_restarted, 0u);
  EXPECT_GT(out.result.paths_restarted, 0u);
  if (cell.config.engine.kind == EngineKind::kNative) {
    EXPECT_GT(out.result.recovery_seconds, 0);
    return;
  }
  if (out.fault != "") return;
  ASSERT_TRUE(out.result.cycle->stop.has_value());
  const cycle::StopTimes& stop = *out.result.cycle->stop;
  EXPECT_EQ(stop.resource, cell.config.faults.resource.number);
  // Word of it, the silence, and at least the way to the resources and back.
  const auto latency = static_cast<Cycle>(cell.config.topology.link.latency_cycles);
  EXPECT_EQ(stop.noticed, stop.stopped + latency + static_cast<Cycle>(cell.config.faults.resource.silence_cycles));
  EXPECT_GE(stop.restarted, stop.noticed + 2 * latency);
  EXPECT_LT(stop.restarted, out.result.cycle->cycles);
}

TEST(StoppedResource, ItsRaysBeginAgainElsewhereAndNothingChanges) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 1000, 0), 400, 2);
  for (const EngineKind engine : {EngineKind::kNative, EngineKind::kCycle})
    for (const Traversal traversal : {Traversal::kSpread, Traversal::kOrdered, Traversal::kTreelet})
      for (const TopologyShape shape :
           {TopologyShape::kRing, TopologyShape::kBidirectional, TopologyShape::kPointToPoint,
            TopologyShape::kMultiRing, TopologyShape::kHierarchical, TopologyShape::kBus}) {
        // The native engine waits a tenth of a second each time.
        if (engine == EngineKind::kNative &&
            (shape > TopologyShape::kBidirectional || traversal == Traversal::kTreelet))
          continue;
        Cell cell = with_a_stop(engine, shape == TopologyShape::kRing ? 2 : 4, 1, 30);
        cell.config.collections.traversal = traversal;
        cell.config.topology.shape = shape;
        SCOPED_TRACE(cell.text());
        expect_recovery(scene, cell);
      }
}

TEST(StoppedResource, WithBundlesHashedHomesAndTravellingRays) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 1000, 0), 300, 2);
  for (const EngineKind engine : {EngineKind::kNative, EngineKind::kCycle})
    for (int what = 0; what < 6; ++what) {
      const std::int64_t resources = what == 2 ? 2 : 3;
      Cell cell = with_a_stop(engine, resources, resources - 1, 20);
      Config& c = cell.config;
      if (what == 0) {
        c.bundles.size = 4;
      } else if (what == 1 || what == 2) {
        c.collections.home = Home::kHash;
        c.collections.when_full = WhenFull::kSpill;
      } else if (what == 3) {
        c.collections.home = Home::kLocal;
      } else {
        if (engine == EngineKind::kCycle) continue;  // rays do not travel there
        c.rays.placement = what == 4 ? Placement::kFirstTaker : Placement::kAddressed;
      }
      SCOPED_TRACE(cell.text());
      expect_recovery(scene, cell);
    }
}

TEST(StoppedResource, OverFailingLinksToo) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 1000, 0), 200, 2);
  for (const EngineKind engine : {EngineKind::kNative, EngineKind::kCycle}) {
    Cell cell = with_a_stop(engine, 3, 0, 10);
    cell.config.faults.links.drop = 0.1;
    cell.config.rays.placement = Placement::kRoundRobin;
    expect_recovery(scene, cell);
  }
}

TEST(StoppedResource, MayHaveBeenShadingOrWaitingForOpacity) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 1000, 0), 400, 2);
  Cell cell = with_a_stop(EngineKind::kCycle, 3, 1, 10);
  cell.config.shading.idle_resources_shade = true;
  cell.config.shading.cycles_per_shade = 3000;  // so that all help
  cell.config.shading.workers = 1;
  cell.config.faults.resource.silence_cycles = 500;
  expect_recovery(scene, cell);
}

// Where few workers answer slowly, many rays wait for an answer at any time, those of the one that stops among them.
TEST(StoppedResource, MayHaveQuestionsOpen) {
  const accel::HashedStop stop(0.4);
  TestScene scene(accel::passing_scene(BuiltinScene::kSpheres, 20, run_seed()), 200, 3, 0.5f, &stop);
  for (const EngineKind engine : {EngineKind::kNative, EngineKind::kCycle})
    for (const std::int64_t after : {5, 20, 60}) {
      SCOPED_TRACE(testing::Message() << "CAROUSEL_SEED=" << run_seed() << " engine " << static_cast<int>(engine)
                                      << " after " << after);
      Cell cell = with_a_stop(engine, 3, 1, after);
      cell.config.testers.any_hit = TestersConfig::AnyHit::kShader;
      cell.config.shading.workers = 1;
      cell.config.shading.cycles_per_any_hit = 200;
      cell.config.faults.resource.silence_cycles = 500;
      expect_recovery(scene, cell);
    }
}

// The outcome is the same whatever the host's threads do.
TEST(StoppedResource, UnderVirtualTimeIsTheSameForAnyNumberOfThreads) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 1000, 0), 400, 2);
  Cell cell = with_a_stop(EngineKind::kCycle, 4, 2, 25);
  cell.threads = 1;
  const Outcome one = run_cell(scene, cell);
  cell.threads = 3;
  const Outcome three = run_cell(scene, cell);
  EXPECT_EQ(one.fault + three.fault, "");
  EXPECT_EQ(one.result.cycle, three.result.cycle);
  EXPECT_EQ(one.result.rays_restarted, three.result.rays_restarted);
  EXPECT_EQ(one.result.packets_discarded, three.result.packets_discarded);
}

TEST(StoppedResource, WhenAllIsDoneIsNotWaitedFor) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 1000, 0), 50, 1);
  Cell cell = with_a_stop(EngineKind::kCycle, 2, 1, 1'000'000'000);
  const Outcome never = run_cell(scene, cell);
  ASSERT_EQ(never.fault, "");
  // One of them completes the last ray of the run, and stops then.
  Cycle first_end = kNever;
  for (const std::int64_t resource : {0, 1}) {
    cell.config.faults.resource.number = resource;
    cell.config.faults.resource.after_rays =
        static_cast<std::int64_t>(never.result.resources[static_cast<std::size_t>(resource)].rays_completed);
    const Outcome late = run_cell(scene, cell);
    EXPECT_EQ(late.fault, "");
    first_end = std::min(first_end, late.result.cycle->cycles);
  }
  EXPECT_LT(first_end, never.result.cycle->cycles + 1000);
}

// Packets whose rays have all missed may still be on their way home when the last ray is complete. A resource stops
// after as many rays as it completes, or some less.
TEST(StoppedResource, MayStopWhenItsLastPacketsBringNothing) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 1000, 0), 100, 0);
  std::uint64_t discarded = 0;
  for (const std::int64_t resources : {8, 16}) {
    Cell cell = with_a_stop(EngineKind::kNative, resources, 0, 1'000'000'000);
    cell.config.topology.shape = TopologyShape::kBidirectional;
    cell.threads = 1;  // steps repeat each time; packets go backwards by one resource a round of steps
    const Outcome never = run_cell(scene, cell);
    ASSERT_EQ(never.fault, "");
    for (std::int64_t number = 0; number < resources; ++number)
      for (std::int64_t less = 0; less < 2; ++less) {
        const ResourceStatistics& all = never.result.resources[static_cast<std::size_t>(number)];
        cell.config.faults.resource.number = number;
        cell.config.faults.resource.after_rays = static_cast<std::int64_t>(all.rays_completed) - less;
        const Outcome late = run_cell(scene, cell);
        EXPECT_EQ(late.fault, "") << number << " of " << resources << ", " << less;
        if (late.result.rays_restarted == 0) discarded += late.result.packets_discarded;
      }
  }
  EXPECT_GT(discarded, 0u) << "none stopped with packets on their way and no ray that needs them";
}

TEST(StoppedResource, WithoutRecoveryTheRunSaysWhatIsMissing) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 1000, 0), 200, 1);
  for (const EngineKind engine : {EngineKind::kNative, EngineKind::kCycle}) {
    Cell cell = with_a_stop(engine, 3, 2, 10);
    cell.config.faults.resource.recover = false;
    const Outcome out = run_cell(scene, cell);
    EXPECT_NE(out.fault.find("resource 2 stopped and faults.resource.recover is off: "), std::string::npos)
        << out.fault;
    EXPECT_NE(out.fault.find(" rays are missing, of paths "), std::string::npos) << out.fault;
  }
}

}  // namespace
}  // namespace carousel::ringbus
