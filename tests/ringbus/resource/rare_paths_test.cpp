// Random machines with little of everything: rays and packets are conserved, runs end, and the code that runs only
// rarely has run.
#include <gtest/gtest.h>

#include "tests/ringbus/identity/machine_space.h"

namespace carousel::ringbus {
namespace {

/// Machines with little of everything.
MachineSpace scarce_machines() {
  return MachineSpace(machine_factors_with({{"topology.resources", {"2", "3", "7"}},
                                            {"topology.link.depth", {"1", "2"}},
                                            {"rays.slots_per_resource", {"1", "3", "40"}},
                                            {"packets.rays", {"1", "3", "8"}},
                                            {"collections.ready", {"1", "4", "50"}},
                                            {"bundles.size", {"0", "2"}},
                                            {"test.storage", {"least"}}}));
}

TEST(RarePaths, RunAndLoseNothing) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 30), 250, 2);
  MachineSpace machines = scarce_machines();
  std::vector<std::string> with{"engine.kind=native",        "test.non_opaque=false", "test.link_faults=false",
                                "faults.resource.kind=none", "bundles.size=0",        "cull_planes.count=0"};
  if (kThreadSanitizer) with.push_back("engine.threads=2");
  // Little storage for many rays that go breadth first, one a packet: of these machines one in nine comes to the
  // reserve, of the others one in a thousand.
  std::vector<std::string> crowded = with;
  crowded.insert(crowded.end(), {"collections.when_full=reserve", "collections.policy=oldest",
                                 "collections.traversal!=treelet", "packets.shapes=single", "packets.made_per=child",
                                 "packets.rays=1", "rays.slots_per_resource=40", "topology.resources=2"});
  ResourceStatistics sum;
  std::uint64_t spilled = 0, refusals = 0, reused = 0, waits = 0, bubbles = 0;
  const auto stalls = [&](StallReason reason) { return sum.stalls[reason]; };
  // Fewer might miss some of the code. Of 80 machines half have two threads, for ThreadSanitizer all.
  const auto count = static_cast<std::uint32_t>(std::max(kThreadSanitizer ? 40 : 80, cell_count(80)));
  const auto keep_running = [&](std::uint32_t done) {
    return done < count || (stalls(StallReason::kReserve) == 0 && done < 20 * count);
  };
  for (std::uint32_t seed = run_seed(); keep_running(seed - run_seed()); ++seed) {
    std::mt19937 random(seed * 104729);
    const Cell cell = machines.draw_cell(random, seed % 2 == 0 ? with : crowded);
    const Outcome out = run_cell(scene, cell);
    EXPECT_EQ(out.fault, "") << "seed " << seed << ": " << cell.text();
    sum += out.sum;
    spilled += out.spilled;
    refusals += out.refusals;
    waits += out.result.slot_waits;
    bubbles += out.sum.bubbles;
    const auto slots = static_cast<std::uint64_t>(cell.config.topology.resources * cell.config.rays.slots_per_resource);
    reused += out.result.slots_used > slots ? out.result.slots_used - slots : 0;
  }
  EXPECT_GT(stalls(StallReason::kReserve), 0u) << "the reserve was never entered";
  EXPECT_GT(stalls(StallReason::kStorage), 0u) << "storage never held anything back";
  EXPECT_GT(stalls(StallReason::kCredits), 0u) << "credits never ran out";
  EXPECT_GT(stalls(StallReason::kLink), 0u) << "no link was ever full";
  EXPECT_GT(stalls(StallReason::kSlots), 0u) << "travelling rays never waited for slots";
  EXPECT_GT(waits, 0u) << "new rays never waited for slots";
  EXPECT_GT(refusals, 0u) << "no queue ever refused";
  EXPECT_GT(spilled, 0u) << "nothing ever spilled";
  EXPECT_GT(reused, 0u) << "no slot was ever reused";
  EXPECT_GT(bubbles, 0u) << "no packet ever passed without finding a ray";
}

// A sender may refill a queue while it is read. Taking in more than the link holds then filled the ring in spite of the
// bubble rule, one run in some thousand (found by script/soak).
TEST(RarePaths, BubbleRingDoesNotFillFromQueuesRefilledMeanwhile) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "Debian's TBB is not instrumented and would be reported";
#endif
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 1000, 0), 200, 3);
  Cell cell;
  Config& c = cell.config;
  cell.threads = 4;
  c.topology.resources = 5;
  c.topology.shape = TopologyShape::kBidirectional;
  c.topology.flow = Flow::kBubble;
  c.topology.link.queue = QueueKind::kTbbBounded;
  c.topology.link.depth = 2;
  c.rays.slots_per_resource = 1;
  c.rays.placement = Placement::kFirstTaker;
  c.packets.shapes = PacketShapes::kSingle;
  c.collections.ready = 1;
  c.collections.policy = Policy::kFullest;
  c.collections.select = Select::kStrict;
  c.collections.home = Home::kHash;
  c.collections.when_full = WhenFull::kSpill;
  c.shading.workers = 2;
  for (int run = 0; run < cell_count(5); ++run) ASSERT_EQ(run_cell(scene, cell).fault, "") << "run " << run;
}

}  // namespace
}  // namespace carousel::ringbus
