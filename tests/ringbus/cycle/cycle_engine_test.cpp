// The cycle engine: the same cycles for any number of threads (CycleEngine); sums that agree, rays and packets
// conserved at every step, on one thread (CycleLedgers).
#include <map>

#include <gtest/gtest.h>

#include "ringbus/topology/topology.h"
#include "tests/ringbus/identity/machine_space.h"

namespace carousel::ringbus {
namespace {

/// A machine under virtual time without faults, on opaque scenes, without bundles and planes or with any.
Cell random_cell(std::uint32_t seed, bool plain = true) {
  std::mt19937 random(seed);
  std::vector<std::string> with{"engine.kind=cycle", "test.non_opaque=false", "test.link_faults=false",
                                "faults.resource.kind=none"};
  if (plain) with.insert(with.end(), {"bundles.size=0", "cull_planes.count=0"});
  return all_machines().draw_cell(random, with);
}

TEST(CycleEngine, TakesTheSameCyclesOnAnyNumberOfThreads) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 600, 0), 60, 2);
  for (std::uint32_t seed = run_seed(); seed < run_seed() + static_cast<std::uint32_t>(cell_count(8)); ++seed) {
    Cell cell = random_cell(seed, seed % 2 == 0);
    cell.config.topology.link.latency_cycles = std::max<std::int64_t>(4, cell.config.topology.link.latency_cycles);
    cell.threads = 1;
    const Outcome alone = run_cell(scene, cell);
    ASSERT_EQ(alone.fault, "") << "seed " << seed << ": " << cell.text();
    ASSERT_GT(alone.result.cycle->cycles, 0u);
    for (const std::size_t threads : {2, 3}) {
      cell.threads = threads;
      const Outcome together = run_cell(scene, cell);
      ASSERT_EQ(together.fault, "") << "seed " << seed << ": " << cell.text();
      EXPECT_EQ(together.result.threads,
                std::min<std::size_t>(threads, static_cast<std::size_t>(cell.config.topology.resources)));
      EXPECT_TRUE(*together.result.cycle == *alone.result.cycle) << "seed " << seed << ": " << cell.text();
      EXPECT_TRUE(together.result.resources == alone.result.resources) << "seed " << seed << ": " << cell.text();
    }
  }
}

// A resource deals with most events by a part of a step (tile.cpp). One that is to pause after more rays than there are
// takes a whole step at every event, and nothing may come of that.
TEST(CycleLedgers, PartsOfAStepDoAsMuchAsTheWhole) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 300), 300, 3);
  const auto count = static_cast<std::uint32_t>(cell_count(40));
  for (std::uint32_t seed = run_seed(); seed < run_seed() + count; ++seed) {
    Cell cell = random_cell(seed + 2000, seed % 2 == 0);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + cell.text());
    const Outcome parts = run_cell(scene, cell);
    ASSERT_EQ(parts.fault, "");
    cell.config.faults.resource = {FaultsConfig::Resource::Kind::kPause, seed % cell.config.topology.resources,
                                   1'000'000'000, 1, 4};
    const Outcome whole = run_cell(scene, cell);
    ASSERT_EQ(whole.fault, "");
    EXPECT_TRUE(*whole.result.cycle == *parts.result.cycle);
    EXPECT_TRUE(whole.result.resources == parts.result.resources);
  }
}

TEST(CycleLedgers, LedgersAddUp) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 300), 600, 3);
  std::uint64_t transforms = 0, jobs = 0, waited = 0;
  const auto count = static_cast<std::uint32_t>(cell_count(40));
  const auto keep_running = [&](std::uint32_t done) {
    return done < count || ((jobs == 0 || transforms == 0 || waited == 0) && done < 40 * count);
  };
  for (std::uint32_t seed = run_seed(); keep_running(seed - run_seed()); ++seed) {
    const Cell cell = random_cell(seed + 1000);
    const Outcome out = run_cell(scene, cell);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + cell.text());
    ASSERT_EQ(out.fault, "");
    const cycle::CycleResult& c = *out.result.cycle;
    for (std::size_t r = 0; r < c.tiles.size(); ++r) {
      const cycle::TileResult& tile = c.tiles[r];
      Cycle sum = 0;
      for (const Cycle state : tile.states) sum += state;
      EXPECT_EQ(sum, c.cycles);
      const Cycle testing = tile.states[static_cast<std::size_t>(cycle::TileState::kTesting)];
      for (const auto [kind, bank] : tile.units) EXPECT_LE(bank.busy, testing);
      for (const auto [kind, bank] : tile.units) {
        Cycle busy = 0;
        for (std::size_t state = 0; state < cycle::kTileStates; ++state) {
          EXPECT_LE(bank.busy_in[state], tile.states[state]);
          busy += bank.busy_in[state];
        }
        EXPECT_EQ(bank.busy, busy);
      }
      EXPECT_LE(tile.dispatch.busy, c.cycles);
      // Little's law: packets under way = rate times time, over a whole run without an error.
      EXPECT_EQ(tile.round_trips.count(), out.result.resources[r].packets_issued);
      EXPECT_EQ(tile.packet_cycles, tile.round_trips.sum());
      // Jobs are shaded whole.
      const Cycle shaded = tile.states[static_cast<std::size_t>(cycle::TileState::kShading)];
      const Cycle job = static_cast<Cycle>(cell.config.shading.cycles_per_shade);
      EXPECT_EQ(job == 0 ? shaded : shaded % job, 0u);
      jobs += job == 0 ? 0 : shaded / job;
      // The banks are busy for the tests that the resource counted, rounded up a packet at a time; behind a distributor
      // for the mean of its testers, rounded down.
      const TesterUnits& box = cell.config.testers.units[UnitKind::kBox];
      const auto testers = static_cast<std::uint64_t>(tile.distributor ? cell.config.testers.distributor.testers : 1);
      EXPECT_GE((tile.units[UnitKind::kBox].busy * testers + testers - 1) *
                    static_cast<std::uint64_t>(box.units * cell.config.testers.simd.lanes),
                out.result.resources[r].tests.box);
      transforms += tile.units[UnitKind::kTransform].busy;
    }
    std::uint64_t hops = 0;
    const Topology topology(cell.config.topology);
    const std::vector<Topology::Wire>& wires = topology.wires();
    for (std::size_t l = 0; l < c.links.size(); ++l) {
      EXPECT_LE(c.links[l].use.busy + c.links[l].use.stalled, c.cycles);
      const std::int64_t own = l < wires.size() ? wires[l].depth : 0;  // 0: as topology.link says
      EXPECT_LE(c.links[l].queue.most, static_cast<std::uint64_t>(own > 0 ? own : cell.config.topology.link.depth));
      EXPECT_LE(c.links[l].queue.packet_cycles, c.links[l].queue.most * c.cycles);
      waited += c.links[l].queue.packet_cycles;
      hops += out.result.links[l].statistics.packets;
    }
    EXPECT_EQ(hops, c.hops);
    std::uint64_t misses = 0;
    for (const CacheCounts& cache : c.caches) {
      EXPECT_EQ(cache.lines, cache.hits + cache.merged + cache.misses);
      misses += cache.misses + cache.write_fetches + cache.walk_reads;
    }
    for (const AheadCounts& ahead : c.fetched_ahead) misses += ahead.fetched;
    EXPECT_EQ(misses, c.memory.lines);
    EXPECT_LE(c.memory.busy, c.cycles);
    EXPECT_LE(c.shading.busy, c.cycles * static_cast<std::uint64_t>(shader_workers(cell.config)));
  }
  EXPECT_GT(transforms, 0u);
  EXPECT_GT(jobs, 0u);
  EXPECT_GT(waited, 0u);
}

/// Follows a whole run: every ray that is given a slot joins a collection, is handed over and is shaded, in this
/// order, and no more are under way than there are slots; a packet is out at most once, with one set of rays.
class Conservation {
 public:
  explicit Conservation(std::uint64_t slots) : slots_(slots) {}

  void follow(const cycle::Step& step) {
    switch (step.kind) {
      case cycle::StepKind::kPlace:
        placed_ += step.rays;
        break;
      case cycle::StepKind::kNewRays:
        joined_ += step.rays;
        break;
      case cycle::StepKind::kComplete:
        completed_ += step.rays;
        break;
      case cycle::StepKind::kShade:
        shaded_ += step.rays;
        break;
      case cycle::StepKind::kTestedRay:
        break;
      case cycle::StepKind::kIssue:
        ASSERT_TRUE(out_.emplace(step.packet, step.rays).second) << cycle::step_text(step);
        break;
      default: {
        const auto packet = out_.find(step.packet);
        ASSERT_TRUE(packet != out_.end()) << cycle::step_text(step);
        if (step.rays == 0) packet->second = 0;  // it carried memberships, and has been to their home
        ASSERT_EQ(packet->second, step.rays) << cycle::step_text(step);
        if (step.kind == cycle::StepKind::kRetire) out_.erase(packet);
      }
    }
    ASSERT_TRUE(shaded_ <= completed_ && completed_ <= joined_ && joined_ <= placed_ && placed_ - completed_ <= slots_)
        << cycle::step_text(step) << ": " << placed_ << " placed, " << joined_ << " joined, " << completed_
        << " completed, " << shaded_ << " shaded, " << slots_ << " slots";
  }
  void expect_all(std::uint64_t rays) const {
    EXPECT_TRUE(out_.empty());
    for (const std::uint64_t count : {placed_, joined_, completed_, shaded_}) EXPECT_EQ(count, rays);
  }

 private:
  std::uint64_t slots_, placed_ = 0, joined_ = 0, completed_ = 0, shaded_ = 0;
  std::map<std::uint32_t, std::uint32_t> out_;  // rays by packet
};

TEST(CycleLedgers, ConservesRaysAndPacketsAtEveryStep) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 300), 300, 3);
  const auto machines = static_cast<std::uint32_t>(cell_count(12));
  std::size_t epochs = 0;
  for (std::uint32_t seed = run_seed(); seed < run_seed() + machines; ++seed) {
    Cell cell = random_cell(seed + 3000);
    cell.trace = {0, kNever};
    const Outcome out = run_cell(scene, cell);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + cell.text());
    ASSERT_EQ(out.fault, "");
    Conservation conservation(
        static_cast<std::uint64_t>(cell.config.rays.slots_per_resource * cell.config.topology.resources));
    for (const cycle::Step& step : out.result.cycle->steps) ASSERT_NO_FATAL_FAILURE(conservation.follow(step));
    conservation.expect_all(scene.rays());
    epochs += out.result.cycle->epochs.digests.size();
  }
  EXPECT_GT(epochs, machines);
}

// Without flow control a small ring fills up. The run must end and say who waits for whom.
TEST(CycleLedgers, StuckRingNamesTheCircle) {
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
  c.testers.contexts = 1;
  const std::string fault = run_cell(scene, cell).fault;
  EXPECT_NE(fault.find("nothing moves any more"), std::string::npos) << fault;
  EXPECT_NE(fault.find("a circle of waits: resource "), std::string::npos) << fault;
  EXPECT_NE(fault.find("(first ray "), std::string::npos) << fault;
  c.topology.flow = Flow::kCredits;
  EXPECT_EQ(run_cell(scene, cell).fault, "");
}

}  // namespace
}  // namespace carousel::ringbus
