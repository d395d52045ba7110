// The cycle engine: the same hits as everybody, and the same cycles for any number of threads.
#include <gtest/gtest.h>

#include "tests/ringbus/identity_cells.h"

namespace carousel::ringbus {
namespace {

TEST(CycleIdentity, Cornell) {
  TestScene scene(builtin_scene(BuiltinScene::kCornell, 0, 0), 400, 3);
  expect_one_digest(scene, cycle_factors(), 11, 15);
}

TEST(CycleIdentity, Terrain) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 400, 3);
  expect_one_digest(scene, cycle_factors(), 12, 15);
}

TEST(CycleIdentity, ThousandsOfInstancesFromFarAway) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 3000), 800, 3, 100.0f);
  expect_one_digest(scene, cycle_factors(), 13, 15);
}

/// Machines of the random cells of `seed`.
Cell random_cell(std::uint32_t seed) {
  const std::vector<Factor> factors = cycle_factors();
  std::mt19937 random(seed);
  std::vector<int> row(factors.size());
  Cell cell;
  do {
    for (std::size_t f = 0; f < row.size(); ++f) row[f] = static_cast<int>(random() % factors[f].levels.size());
    cell = cell_of(factors, row);
  } while (!possible(cell.config));
  return cell;
}

TEST(CycleEngine, TakesTheSameCyclesOnAnyNumberOfThreads) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 300, 2);
  for (std::uint32_t seed = run_seed(); seed < run_seed() + static_cast<std::uint32_t>(cell_count(6)); ++seed) {
    Cell cell = random_cell(seed);
    cell.config.topology.link.latency_cycles = std::max<std::int64_t>(4, cell.config.topology.link.latency_cycles);
    cell.threads = 1;
    const Outcome alone = run_cell(scene, cell);
    ASSERT_EQ(alone.fault, "") << "seed " << seed << ": " << cell.text();
    ASSERT_GT(alone.result.cycle->cycles, 0u);
    for (const std::size_t threads : {2, 3, 8}) {
      cell.threads = threads;
      const Outcome together = run_cell(scene, cell);
      ASSERT_EQ(together.fault, "") << "seed " << seed << ": " << cell.text();
      EXPECT_EQ(together.result.threads, std::min<std::size_t>(threads, static_cast<std::size_t>(cell.config.topology.resources)));
      EXPECT_TRUE(*together.result.cycle == *alone.result.cycle) << "seed " << seed << ": " << cell.text();
      EXPECT_TRUE(together.result.resources == alone.result.resources) << "seed " << seed << ": " << cell.text();
    }
  }
}

TEST(CycleEngine, LedgersAddUp) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 300), 600, 3);
  std::uint64_t transforms = 0, jobs = 0;
  for (std::uint32_t seed = run_seed(); seed < run_seed() + static_cast<std::uint32_t>(cell_count(40)); ++seed) {
    const Cell cell = random_cell(seed + 1000);
    const Outcome out = run_cell(scene, cell);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + cell.text());
    ASSERT_EQ(out.fault, "");
    const cycle::CycleResult& c = *out.result.cycle;
    for (std::size_t r = 0; r < c.tiles.size(); ++r) {
      const cycle::TileResult& tile = c.tiles[r];
      cycle::Cycle sum = 0;
      for (const cycle::Cycle state : tile.states) sum += state;
      EXPECT_EQ(sum, c.cycles);
      const cycle::Cycle testing = tile.states[static_cast<std::size_t>(cycle::TileState::kTesting)];
      for (const cycle::UnitLedger& bank : {tile.box, tile.triangle, tile.transform}) EXPECT_LE(bank.busy, testing);
      EXPECT_LE(tile.handler.busy, c.cycles);
      // Little's law: packets under way = rate times time, over a whole run without an error.
      EXPECT_EQ(tile.round_trips.count(), out.result.resources[r].packets_issued);
      EXPECT_EQ(tile.packet_cycles, tile.round_trips.sum());
      // Jobs are shaded whole.
      const cycle::Cycle shaded = tile.states[static_cast<std::size_t>(cycle::TileState::kShading)];
      const cycle::Cycle job = static_cast<cycle::Cycle>(cell.config.shading.cycles_per_shade);
      EXPECT_EQ(job == 0 ? shaded : shaded % job, 0u);
      jobs += job == 0 ? 0 : shaded / job;
      // What the banks did is what the resource counted, rounded up a packet at a time.
      const TesterUnits& box = cell.config.testers.box;
      EXPECT_GE(tile.box.busy * static_cast<std::uint64_t>(box.units), out.result.resources[r].tests.box);
      transforms += tile.transform.busy;
    }
    std::uint64_t hops = 0;
    for (std::size_t l = 0; l < c.links.size(); ++l) {
      EXPECT_LE(c.links[l].use.busy + c.links[l].use.stalled, c.cycles);
      hops += out.result.links[l].statistics.packets;
    }
    EXPECT_EQ(hops, c.hops);
    std::uint64_t misses = 0;
    for (const cycle::CacheResult& cache : c.caches) {
      EXPECT_EQ(cache.lines, cache.hits + cache.merged + cache.misses);
      misses += cache.misses;
    }
    EXPECT_EQ(misses, c.memory_lines);
    EXPECT_LE(c.memory_busy, c.cycles);
    EXPECT_LE(c.shading_busy, c.cycles * static_cast<std::uint64_t>(cell.config.shading.workers));
  }
  EXPECT_GT(transforms, 0u);
  EXPECT_GT(jobs, 0u);
}

// Without flow control a small ring fills up. The run must end and say who waits for whom.
TEST(CycleEngine, StuckRingNamesTheCircle) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 2000, 1);
  Cell cell;
  Config& c = cell.config;
  c.engine.kind = EngineKind::kCycle;
  c.topology.resources = 4;
  c.topology.flow = Flow::kNone;
  c.topology.link.depth = 1;
  c.packets.rays = c.collections.ready = 4;
  c.collections.when_full = WhenFull::kSpill;
  c.memory.fetch_ahead = 16;
  const std::string fault = run_cell(scene, cell).fault;
  EXPECT_NE(fault.find("nothing moves any more"), std::string::npos) << fault;
  EXPECT_NE(fault.find("a circle of waits: resource "), std::string::npos) << fault;
  EXPECT_NE(fault.find("(first ray "), std::string::npos) << fault;
  c.topology.flow = Flow::kCredits;
  EXPECT_EQ(run_cell(scene, cell).fault, "");
}

}  // namespace
}  // namespace carousel::ringbus
