// Simulations of pilots on several threads: the same results in the same order as on one, progress told by one thread
// at a time, and an error of one simulation reaches the caller. Small enough for ThreadSanitizer.
#include "ringbus/verdict/pilot_runs.h"

#include <atomic>
#include <stdexcept>

#include <gtest/gtest.h>

#include "ringbus/cycle/cycle_engine.h"
#include "tests/ringbus/support/test_machine.h"

namespace carousel::ringbus {
namespace {

constexpr std::uint64_t kPilotRays = 200;

struct PilotCase {
  TestScene scene{builtin_scene(BuiltinScene::kTerrain, 200, 0), kPilotRays, 2};
  std::vector<Config> machines;
  std::vector<const Config*> wanted;
  RunResult run;

  PilotCase() {
    for (const std::int64_t workers : {1, 2, 3, 4, 6, 8}) {
      Config& config = machines.emplace_back();
      config.engine.kind = EngineKind::kCycle;
      config.topology.resources = 2;
      config.rays.slots_per_resource = 16;
      config.shading.workers = workers;
    }
    for (const Config& config : machines) wanted.push_back(&config);
    ScatterWorkload workload = scene.workload();
    run = run_cycle(machines[0], scene.accel(machines[0].bvh), scene.size(), workload, on_threads(1));
  }

  std::vector<RunResult> simulate(std::size_t threads, const PilotFactory& pilots, const SearchObserver& observe) {
    const SearchedRun searched{run, kPilotRays};
    const RunOptions options = on_threads(threads);
    PilotRuns runs(scene.accel(machines[0].bvh), scene.size(), pilots, searched, options, observe);
    runs.begin("pilot", machines.size(), kPilotRays);
    return runs.simulate(wanted);
  }
};

TEST(PilotRuns, AreTheSameOnThreads) {
  PilotCase pilot;
  const PilotFactory pilots = [&](const Config&, std::uint64_t, std::uint64_t) { return pilot.scene.new_workload(); };
  const std::vector<RunResult> alone = pilot.simulate(1, pilots, {});
  SearchProgress last;  // no lock: the observer is called by one thread at a time
  const std::vector<RunResult> together = pilot.simulate(3, pilots, [&](const SearchProgress& at) { last = at; });
  ASSERT_EQ(together.size(), alone.size());
  for (std::size_t i = 0; i < alone.size(); ++i) {
    EXPECT_EQ(together[i].cycle->cycles, alone[i].cycle->cycles) << "machine " << i;
    EXPECT_EQ(together[i].rays_completed, alone[i].rays_completed) << "machine " << i;
  }
  EXPECT_NE(alone.front().cycle->cycles, alone.back().cycle->cycles);
  EXPECT_EQ(last.of, alone.size());
}

// A frame of a series begins with what the frame before has left in the caches, and so do its pilots.
TEST(PilotRuns, OfAWarmFrameAreAsWarm) {
  PilotCase pilot;
  const accel::Accel& accel = pilot.scene.accel(pilot.machines[0].bvh);
  RunOptions options = on_threads(1);
  options.warm = {.start = &pilot.run.cycle->cached_lines};
  ScatterWorkload workload = pilot.scene.workload();
  const RunResult second = run_cycle(pilot.machines[0], accel, pilot.scene.size(), workload, options);
  ASSERT_LT(second.cycle->cycles, pilot.run.cycle->cycles) << "the caches do not matter";
  const PilotFactory pilots = [&](const Config&, std::uint64_t, std::uint64_t) { return pilot.scene.new_workload(); };
  const SearchedRun searched{second, kPilotRays, &pilot.run.cycle->cached_lines};
  const RunOptions plain = on_threads(1);
  const SearchObserver nobody;
  PilotRuns runs(accel, pilot.scene.size(), pilots, searched, plain, nobody);
  runs.begin("pilot", 1, kPilotRays);
  EXPECT_EQ(runs.simulate({pilot.wanted.front()}).front().cycle->cycles, second.cycle->cycles);
}

TEST(PilotRuns, HandOnAnError) {
  PilotCase pilot;
  std::atomic<int> begun{0};
  const PilotFactory pilots = [&](const Config&, std::uint64_t, std::uint64_t) {
    if (++begun == 2) throw std::runtime_error("no such pilot");
    return pilot.scene.new_workload();
  };
  EXPECT_THROW(pilot.simulate(3, pilots, {}), std::runtime_error);
}

}  // namespace
}  // namespace carousel::ringbus
