// Warps of rays: latencies to the cycle with a mock cache, steps that wait for the slowest lane, lines that are read
// once, stacks in few registers.
#include "ringbus/cycle/tile/warps/warp_tile.h"

#include <gtest/gtest.h>

#include "tests/ringbus/support/test_machine.h"
#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus::cycle::warp_tile_test {
namespace {

constexpr Cycle kTest = 7, kRecord = sizeof(RayRecord) / 16, kWire = 5;

/// One resource with warps, with a cache that answers every request after the same time. It does not scatter.
class LoneWarps {
 public:
  LoneWarps(TestScene& scene, const Config& config)
      : config_(config),
        machine_(config_, scene.accel(config_.bvh), scene.size()),
        scene_(scene),
        memory_(machine_.accel, config_.accuracy),
        tile_(ResourceId(0), machine_, memory_, tile_settings(config_, ResourceId(0), scene.size(), true, {}),
              {&new_rays_, &completed_, &fetch_, &fetched_}) {}

  /// Loads these rays of the scene at cycle `at`.
  void load(const std::vector<std::size_t>& wanted, Cycle at) {
    RayBatch all, rays;
    scene_.new_workload()->generate(WorkerId(0), *std::max_element(wanted.begin(), wanted.end()) + 1, all);
    for (const std::size_t ray : wanted) rays.push_back(all[ray]);
    machine_.control.submit(rays);
    std::vector<RayGroup> groups;
    machine_.control.collect(ResourceId(0), groups);
    for (RayGroup& group : groups) new_rays_.send(at, {std::move(group.ids)});
  }

  void run(Cycle answer) {
    for (Cycle now; (now = std::min(tile_.next(), fetch_.next())) != kNever;) {
      while (fetch_.next() <= now) {
        const Cycle at = fetch_.next();
        const FetchRequest request = fetch_.take();
        if (request.written > 0) {
          written += request.written;
          continue;
        }
        // Requests of one cycle follow one another on the wire, and the ray waits for the last.
        memory_wait += at == last_fetch_ + 1 ? 1 : 34 / 2 + answer;
        last_fetch_ = at;
        fetched_.send(at + answer, {request.tag});
        ++fetches;
      }
      tile_.run(now + 1);
    }
    while (completed_.next() != kNever) {
      last_completed = completed_.next();
      const CompletedRays rays = completed_.take();
      messages += 1;
      completed += rays.rays.size();
      std::vector<std::uint32_t> slots = rays.slots;
      machine_.control.free(ResourceId(0), slots);
    }
    EXPECT_EQ(tile_.describe(), "");
  }
  TileResult result() {
    tile_.close(last_completed);
    return tile_.result();
  }
  std::uint64_t strips() const { return tile_.statistics().local_rays; }
  std::uint64_t fetches = 0, completed = 0, messages = 0, written = 0;
  Cycle memory_wait = 0, last_completed = 0;

 private:
  Config config_;
  Machine machine_;
  TestScene& scene_;
  ShapeMemory memory_;
  LooseChannel<NewRays> new_rays_;
  LooseChannel<CompletedRays> completed_;
  LooseChannel<FetchRequest> fetch_;
  LooseChannel<FetchAnswer> fetched_;
  Cycle last_fetch_ = 0;
  WarpTile tile_;
};

/// Units enough for any step, whose tests all take the same time.
Config warps_of(std::int64_t lanes) {
  Config c;
  c.engine.kind = EngineKind::kCycle;
  c.topology.shape = TopologyShape::kIndependent;
  c.topology.resources = 1;
  c.topology.link.latency_cycles = kWire;
  c.topology.link.bytes_per_cycle = 16;
  for (const UnitKind kind : {UnitKind::kBox, UnitKind::kTriangle})
    c.testers.units[kind] = {1024, 1, static_cast<std::int64_t>(kTest)};
  c.testers.simt.warp = lanes;
  c.testers.simt.warps = 1;
  c.testers.simt.lines_per_cycle = 64;
  c.testers.simt.stack_entries = 64;
  c.memory.l2_latency_cycles = 34;
  c.memory.shape_buffer_kib = 1024;  // whatever has been read stays
  return c;
}

TestScene terrain() {
  return TestScene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 50, 0);
}

/// The time that rays take whose shapes are all there.
Cycle warm_cycles(TestScene& scene, const Config& config, const std::vector<std::size_t>& rays) {
  LoneWarps lone(scene, config);
  for (const std::size_t ray : rays) lone.load({ray}, 0);
  lone.run(100);
  const Cycle begin = 1'000'000;
  lone.load(rays, begin);
  const std::uint64_t fetched = lone.fetches;
  lone.run(100);
  EXPECT_EQ(lone.fetches, fetched);
  EXPECT_EQ(lone.completed, 2 * rays.size());
  return lone.last_completed - begin;
}

std::uint64_t strips_of(TestScene& scene, std::size_t ray) {
  LoneWarps lone(scene, warps_of(1));
  lone.load({ray}, 0);
  lone.run(100);
  return lone.strips();
}

TEST(WarpTile, OneRayTakesTheSumOfItsLatencies) {
  TestScene scene = terrain();
  for (std::size_t ray = 0; ray < 10; ++ray) {
    LoneWarps lone(scene, warps_of(1));
    lone.load({ray}, 0);
    lone.run(100);
    EXPECT_EQ(lone.last_completed, lone.memory_wait + kTest * lone.strips() + kRecord + kWire);
    EXPECT_EQ(lone.completed, 1u);
  }
}

TEST(WarpTile, ARayAloneWaitsForItsWarpToFill) {
  TestScene scene = terrain();
  Config config = warps_of(4);
  config.testers.simt.wait_cycles = 50;
  LoneWarps lone(scene, config);
  lone.load({0}, 0);
  lone.run(100);
  EXPECT_EQ(lone.last_completed, 50 + lone.memory_wait + kTest * lone.strips() + kRecord + kWire);
}

// A step is as long as a test, and the warp has as many as its slowest ray. All of its rays go on to shading then.
TEST(WarpTile, AWarpWaitsForItsSlowestRay) {
  TestScene scene = terrain();
  std::uint64_t differ = 0;
  for (std::size_t ray = 0; ray < 10; ++ray) {
    const std::uint64_t a = strips_of(scene, ray), b = strips_of(scene, ray + 10);
    for (const SimtConfig::Step step : {SimtConfig::Step::kWarp, SimtConfig::Step::kLane}) {
      Config config = warps_of(2);
      config.testers.simt.step = step;
      config.testers.simt.wait_cycles = 1000;
      EXPECT_EQ(warm_cycles(scene, config, {ray, ray + 10}), kTest * std::max(a, b) + 2 * kRecord + kWire);
    }
    // One after the other, each takes its own time; the first is on its way while the second is in test.
    EXPECT_EQ(warm_cycles(scene, warps_of(1), {ray, ray + 10}), kTest * (a + b) + kRecord + kWire);
    differ += a != b;
  }
  EXPECT_GT(differ, 0u);
}

// A line a cycle: lanes that want the same lines share them, lanes that want others wait for them.
TEST(WarpTile, LinesAreReadOnceForAllLanes) {
  TestScene scene = terrain();
  Config narrow = warps_of(4);
  narrow.testers.simt.lines_per_cycle = 1;
  const std::uint64_t strips = strips_of(scene, 0);
  LoneWarps one(scene, warps_of(1)), four(scene, warps_of(4));
  one.load({0}, 0);
  one.run(100);
  four.load({0, 0, 0, 0}, 0);
  four.run(100);
  EXPECT_EQ(four.fetches, one.fetches);
  const WarpCounts alone = *one.result().warps, together = *four.result().warps;
  EXPECT_EQ(together.lines_read, alone.lines_read);
  EXPECT_EQ(together.lines_wanted, 4 * alone.lines_wanted);
  EXPECT_EQ(together.tested, 4 * strips);
  EXPECT_EQ(together.steps, strips);
  // The first line of a strip is read at once, each further one a cycle later.
  EXPECT_EQ(warm_cycles(scene, narrow, {0, 0, 0, 0}), (kTest - 1) * strips + alone.lines_read + 4 * kRecord + kWire);
}

// Two rays that go the same way: each step packs them anew, a ray a cycle.
TEST(WarpTile, PackingTakesTime) {
  TestScene scene = terrain();
  Config config = warps_of(2);
  config.testers.simt.compaction = SimtConfig::Compaction::kRepack;
  config.testers.simt.repack_rays_per_cycle = 1;
  const std::uint64_t strips = strips_of(scene, 3);
  EXPECT_EQ(warm_cycles(scene, config, {3, 3}), (2 + kTest) * strips + 2 * kRecord + kWire);
}

// Lanes without a ray take nodes of the one that is left, so that rays have fewer steps, and all of their strips or
// more. A single ray may have more: what a helper finds comes before its own nearest child.
TEST(WarpTile, IdleLanesHelp) {
  TestScene scene = terrain();
  std::uint64_t with = 0, without = 0;
  for (std::size_t ray = 0; ray < 10; ++ray) {
    Config config = warps_of(4);
    config.testers.simt.wait_cycles = 1;
    LoneWarps alone(scene, config);
    config.testers.simt.idle_lanes = SimtConfig::IdleLanes::kHelp;
    LoneWarps helped(scene, config);
    for (LoneWarps* lone : {&alone, &helped}) {
      lone->load({ray}, 0);
      lone->run(100);
      EXPECT_EQ(lone->completed, 1u);
    }
    const WarpCounts a = *alone.result().warps, h = *helped.result().warps;
    EXPECT_GE(h.tested, a.tested);
    EXPECT_EQ(h.tested, h.steps + h.helped);
    with += h.steps;
    without += a.steps;
  }
  EXPECT_LT(with, without);
}

// Entries that the registers do not hold are written, and those that are needed again are read back.
TEST(WarpTile, StacksSpillToMemory) {
  TestScene scene = terrain();
  std::uint64_t spilled = 0, slower = 0;
  for (std::size_t ray = 0; ray < 10; ++ray) {
    Config config = warps_of(1);
    LoneWarps roomy(scene, config);
    config.testers.simt.stack_entries = 1;
    LoneWarps tight(scene, config);
    for (LoneWarps* lone : {&roomy, &tight}) {
      lone->load({ray}, 0);
      lone->run(100);
    }
    EXPECT_EQ(roomy.written, 0u);
    EXPECT_EQ(tight.strips(), roomy.strips());
    const TileResult result = tight.result();
    EXPECT_EQ(tight.written, result.warps->spilled_bytes);
    EXPECT_LE(result.warps->refilled_bytes, result.warps->spilled_bytes);
    // Writing takes no time of the ray, which waits for what it reads.
    EXPECT_EQ(tight.last_completed > roomy.last_completed, result.warps->refilled_bytes > 0);
    spilled += result.warps->spilled_bytes;
    slower += tight.last_completed > roomy.last_completed;
  }
  EXPECT_GT(spilled, 0u);
  EXPECT_GT(slower, 0u);
}

TEST(WarpTile, LanesAddUp) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 300), 600, 3);
  for (const SimtConfig::Compaction compaction : {SimtConfig::Compaction::kNone, SimtConfig::Compaction::kRepack})
    for (const SimtConfig::Step step : {SimtConfig::Step::kWarp, SimtConfig::Step::kLane}) {
      Cell cell;
      cell.config = warps_of(8);
      cell.config.topology.resources = 3;
      cell.config.testers.simt.warps = 3;
      cell.config.testers.simt.stack_entries = 2;
      cell.config.testers.simt.compaction = compaction;
      cell.config.testers.simt.step = step;
      const Outcome out = run_cell(scene, cell);
      ASSERT_EQ(out.fault, "");
      cell.config.testers.simt.warp = 0;
      const Outcome alone = run_cell(scene, cell);
      EXPECT_EQ(out.sum.tests.box, alone.sum.tests.box);
      EXPECT_EQ(out.sum.tests.triangle, alone.sum.tests.triangle);
      EXPECT_EQ(out.sum.local_rays, alone.sum.local_rays);
      std::uint64_t tested = 0;
      for (const TileResult& tile : out.result.cycle->tiles) {
        LaneUse sum;
        for (const LaneUse& bounce : tile.bounces) sum += bounce;
        EXPECT_EQ(sum.lane_cycles, tile.warps->lane_cycles);
        EXPECT_EQ(sum.ray_cycles, tile.warps->ray_cycles);
        EXPECT_LE(sum.ray_cycles, sum.lane_cycles);
        EXPECT_LE(tile.warps->lane_cycles, 8 * 3 * out.result.cycle->cycles);
        EXPECT_LE(tile.warps->rays, 8 * tile.warps->warps);
        EXPECT_EQ(tile.warps->tested, tile.warps->box_tested + tile.warps->leaf_tested);
        EXPECT_LE(tile.warps->lines_read, tile.warps->lines_wanted);
        tested += tile.warps->tested;
      }
      EXPECT_EQ(tested, out.sum.local_rays);
    }
}

}  // namespace
}  // namespace carousel::ringbus::cycle::warp_tile_test
