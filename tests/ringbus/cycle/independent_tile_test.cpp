// The conventional machine: latencies to the cycle with a mock cache, memory hidden by other rays, and the work of
// ordered traversal.
#include "ringbus/cycle/tile/independent_tile.h"

#include <gtest/gtest.h>

#include "tests/ringbus/support/test_machine.h"
#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus::cycle {
namespace {

/// One independent resource, with a cache that answers every request after the same time.
class LoneTile {
 public:
  LoneTile(TestScene& scene, const Config& config)
      : config_(config),
        machine_(config_, scene.accel(config_.bvh), scene.size()),
        scene_(scene),
        memory_(machine_.accel, config_.accuracy),
        tile_(ResourceId(0), machine_, memory_, tile_settings(config_, ResourceId(0), scene.size(), true, {}),
              {&new_rays_, &completed_, &fetch_, &fetched_}) {}

  /// Loads the scene's rays [first, first + count), at cycle 0; `copies` times each.
  void load(std::size_t first, std::size_t count, int copies = 1) {
    RayBatch all, rays;
    scene_.new_workload()->generate(WorkerId(0), first + count, all);
    for (int i = 0; i < copies; ++i)
      rays.insert(rays.end(), all.begin() + static_cast<std::ptrdiff_t>(first), all.end());
    machine_.control.submit(rays);
    std::vector<RayGroup> groups;
    machine_.control.collect(ResourceId(0), groups);
    for (RayGroup& group : groups) new_rays_.send(0, {std::move(group.ids)});
  }

  void run(Cycle answer) {
    for (Cycle now; (now = std::min(tile_.next(), fetch_.next())) != kNever;) {
      while (fetch_.next() <= now) {
        const Cycle at = fetch_.next();
        // Requests of one cycle follow one another on the wire, and the ray waits for the last that is no write.
        const FetchRequest asked = fetch_.take();
        const bool follows = at == last_fetch_ + 1;
        memory_wait += (follows ? 1 : 0) + (follows && !after_write_ ? 0 : asked.written > 0 ? 0 : 34 / 2 + answer);
        if (asked.written > 0) memory_wait -= follows ? 1 : 0;
        last_fetch_ = at;
        after_write_ = asked.written > 0;
        written += asked.written;
        if (after_write_) continue;
        fetched_.send(at + answer, {asked.tag});
        ++fetches;
      }
      tile_.run(now + 1);
    }
    while (completed_.next() != kNever) {
      last_completed = completed_.next();
      completed += completed_.take().rays.size();
    }
    EXPECT_EQ(tile_.describe(), "");
    tile_.close(last_completed);
  }

  TileResult result() const { return tile_.result(); }
  ResourceStatistics statistics() const { return tile_.statistics(); }

  std::uint64_t fetches = 0, completed = 0, written = 0;
  Cycle memory_wait = 0;  ///< cycles that a lone ray waits for its strips and transforms
  Cycle last_completed = 0;

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
  bool after_write_ = false;
  IndependentTile tile_;
};

Config independent_machine() {
  Config c;
  c.engine.kind = EngineKind::kCycle;
  c.topology.shape = TopologyShape::kIndependent;
  c.topology.resources = 1;
  c.topology.link.latency_cycles = 5;
  c.topology.link.bytes_per_cycle = 16;
  c.testers.units[UnitKind::kBox] = {8, 1, 7};
  c.testers.units[UnitKind::kTriangle] = {16, 1, 11};
  c.testers.units[UnitKind::kTransform] = {1, 1, 13};
  c.memory.l2_latency_cycles = 34;
  return c;
}

Cycle in_state(const TileResult& tile, TileState state) {
  return tile.states[static_cast<std::size_t>(state)];
}

TEST(IndependentTile, OneRayTakesTheSumOfItsLatencies) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 300), 50, 1);
  std::uint64_t transforms = 0;
  for (std::size_t ray = 0; ray < 20; ++ray) {
    LoneTile lone(scene, independent_machine());
    lone.load(ray, 1);
    lone.run(100);
    const TileResult tile = lone.result();
    // Units enough for a strip at once, so a bank is busy for a cycle a strip.
    // A strip and its transform are asked for together.
    const Cycle memory = lone.memory_wait;
    const Cycle tests = 7 * tile.units[UnitKind::kBox].busy + 11 * tile.units[UnitKind::kTriangle].busy +
                        13 * tile.units[UnitKind::kTransform].busy;
    const Cycle record = sizeof(RayRecord) / 16, wire = 5;
    EXPECT_EQ(lone.completed, 1u);
    EXPECT_EQ(lone.last_completed, memory + tests + record + wire);
    EXPECT_EQ(in_state(tile, TileState::kMemory), memory);
    EXPECT_EQ(in_state(tile, TileState::kTesting), tests);
    EXPECT_EQ(in_state(tile, TileState::kIdle), record + wire);
    EXPECT_EQ(lone.statistics().tests.transforms, tile.units[UnitKind::kTransform].busy);
    transforms += tile.units[UnitKind::kTransform].busy;
  }
  EXPECT_GT(transforms, 0u);
}

// A ray waits for the entries that it reads back as for shapes. What it writes is before its next request on the wire.
TEST(IndependentTile, AShortStackCostsTheWaitForItsEntries) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 300), 50, 1);
  std::uint64_t spilled = 0, slower = 0;
  for (std::size_t ray = 0; ray < 50; ++ray) {
    Config config = independent_machine();
    config.topology.link.bytes_per_cycle = 256;  // a message takes a cycle
    LoneTile ample(scene, config);
    config.testers.stack_entries = 1;
    LoneTile tight(scene, config);
    for (LoneTile* lone : {&ample, &tight}) {
      lone->load(ray, 1);
      lone->run(100);
    }
    const TileResult tile = tight.result();
    const Cycle tests = 7 * tile.units[UnitKind::kBox].busy + 11 * tile.units[UnitKind::kTriangle].busy +
                        13 * tile.units[UnitKind::kTransform].busy;
    EXPECT_EQ(tight.last_completed, tight.memory_wait + tests + 1 + 5) << ray;
    EXPECT_EQ(in_state(tile, TileState::kMemory), tight.memory_wait) << ray;
    EXPECT_EQ(tight.written, tile.stack.spilled_bytes);
    EXPECT_LE(tile.stack.refilled_bytes, tile.stack.spilled_bytes);
    EXPECT_EQ(tile.stack.pushed_bytes, ample.result().stack.pushed_bytes);
    EXPECT_EQ(ample.written, 0u);
    spilled += tile.stack.refilled_bytes;
    slower += tight.last_completed > ample.last_completed;
  }
  EXPECT_GT(spilled, 0u);
  EXPECT_GT(slower, 0u);
}

// Every strip that a ray is tested against costs a read of its record, a cycle if the port reads one a cycle.
TEST(IndependentTile, RayReadsTakeTime) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 300), 50, 1);
  for (std::size_t ray = 0; ray < 20; ++ray) {
    Config config = independent_machine();
    LoneTile at_once(scene, config);
    config.rays.reads_per_cycle = 1;
    LoneTile one_a_cycle(scene, config);
    for (LoneTile* lone : {&at_once, &one_a_cycle}) {
      lone->load(ray, 1);
      lone->run(100);
    }
    // Units enough for a strip at once: a bank is busy for a cycle a strip, and each strip is of boxes or triangles.
    const TileResult tile = at_once.result();
    const Cycle strips = tile.units[UnitKind::kBox].busy + tile.units[UnitKind::kTriangle].busy;
    EXPECT_EQ(tile.ray_reads.busy, 0u);
    EXPECT_EQ(one_a_cycle.result().ray_reads.busy, strips);
    EXPECT_EQ(one_a_cycle.last_completed, at_once.last_completed + strips);
  }
}

TEST(IndependentTile, AsksForAStripOnceHoweverManyWantIt) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 50, 1);
  LoneTile one(scene, independent_machine()), ten(scene, independent_machine());
  one.load(0, 1);
  one.run(100);
  ten.load(0, 1, 10);
  ten.run(100);
  EXPECT_EQ(ten.completed, 10u);
  EXPECT_EQ(ten.fetches, one.fetches);
  EXPECT_EQ(ten.statistics().tests.box, 10 * one.statistics().tests.box);
  EXPECT_GE(ten.last_completed, one.last_completed);  // no ray has a strip before it is there
  // The ten take turns in the units: at each strip the last begins nine cycles after the first at most.
  const Cycle strips = one.result().units[UnitKind::kBox].busy + one.result().units[UnitKind::kTriangle].busy;
  EXPECT_LE(ten.last_completed, one.last_completed + 9 * strips + 9 * sizeof(RayRecord) / 16);
}

TEST(IndependentTile, FewTestsOfSeveralRaysShareACycle) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 50, 1);
  Config wide = independent_machine();
  wide.testers.units[UnitKind::kBox].units = 80;
  LoneTile one(scene, wide), ten(scene, wide);
  one.load(0, 1);
  one.run(100);
  ten.load(0, 1, 10);  // all at the same strips at the same time, eight boxes each
  ten.run(100);
  EXPECT_EQ(ten.statistics().tests.box, 10 * one.statistics().tests.box);
  EXPECT_EQ(ten.result().units[UnitKind::kBox].busy, one.result().units[UnitKind::kBox].busy);
}

TEST(IndependentTile, OtherRaysHideTheWaitForMemory) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 400, 2);
  const auto cycles = [&](std::int64_t slots) {
    Cell cell;
    cell.config = independent_machine();
    cell.config.rays.slots_per_resource = slots;
    cell.config.packets.rays = 1;
    cell.config.memory.shape_buffer_kib = 16;  // room for a strip of each ray
    cell.config.memory.l2_latency_cycles = 300;
    cell.config.shading.cycles_per_shade = 1;
    const Outcome out = run_cell(scene, cell);
    EXPECT_EQ(out.fault, "");
    return out.result.cycle->cycles;
  };
  EXPECT_LT(cycles(64) * 16, cycles(1));
}

TEST(IndependentTile, TestsWhatOrderedTraversalTests) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 300), 600, 3);
  Cell cell;
  cell.config = independent_machine();
  cell.config.topology.resources = 4;
  const Outcome independent = run_cell(scene, cell);
  cell.config.topology.shape = TopologyShape::kRing;
  cell.config.collections.traversal = Traversal::kOrdered;
  const Outcome ring = run_cell(scene, cell);
  ASSERT_EQ(independent.fault + ring.fault, "");
  EXPECT_EQ(independent.sum.tests.box, ring.sum.tests.box);
  EXPECT_EQ(independent.sum.tests.triangle, ring.sum.tests.triangle);
  EXPECT_LE(independent.sum.tests.transforms, ring.sum.tests.transforms);
  EXPECT_EQ(independent.sum.local_rays, ring.sum.local_rays);
  EXPECT_EQ(independent.sum.packets_issued + independent.sum.visits + independent.sum.hops, 0u);
  EXPECT_TRUE(independent.result.links.empty());
}

TEST(IndependentTile, StackLedgersAddUp) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 600, 0);  // closest hits only
  Cell cell;
  cell.config = independent_machine();
  cell.config.topology.resources = 3;
  const Outcome out = run_cell(scene, cell);
  ASSERT_EQ(out.fault, "");
  for (const TileResult& tile : out.result.cycle->tiles) {
    EXPECT_GT(tile.stack.pushed_bytes, 0u);
    EXPECT_EQ(tile.stack.popped_bytes, tile.stack.pushed_bytes);  // no ray leaves before its stack is empty
    EXPECT_GE(tile.stack.ray_peak_bytes, 4u);
    EXPECT_GT(tile.stack.peak_bytes, tile.stack.ray_peak_bytes);
    EXPECT_LE(tile.stack.peak_bytes, tile.stack.pushed_bytes);
  }
}

}  // namespace
}  // namespace carousel::ringbus::cycle
