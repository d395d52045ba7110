// Simulations of pilots on several threads: the same results in the same order as on one, progress told by one thread
// at a time, and an error of one simulation reaches the caller. Small enough for ThreadSanitizer.
#include "ringbus/verdict/pilot_runs.h"

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/verdict/progress_blocks.h"
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
    PilotRuns runs(scene.accel(machines[0].bvh), scene.size(), pilots, searched, slots_of(machines[0]), options,
                   observe);
    runs.begin("pilot", machines.size(), kPilotRays);
    return runs.simulate(wanted);
  }
};

TEST(PilotRuns, AreTheSameOnThreads) {
  PilotCase pilot;
  const PilotFactory pilots = [&](const Config&, std::uint64_t, std::uint64_t, std::uint64_t) {
    return pilot.scene.new_workload();
  };
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
  const PilotFactory pilots = [&](const Config&, std::uint64_t, std::uint64_t, std::uint64_t) {
    return pilot.scene.new_workload();
  };
  const SearchedRun searched{second, kPilotRays, &pilot.run.cycle->cached_lines};
  const RunOptions plain = on_threads(1);
  const SearchObserver nobody;
  PilotRuns runs(accel, pilot.scene.size(), pilots, searched, slots_of(pilot.machines[0]), plain, nobody);
  runs.begin("pilot", 1, kPilotRays);
  EXPECT_EQ(runs.simulate({pilot.wanted.front()}).front().cycle->cycles, second.cycle->cycles);
}

// The frame goes on from where it had stopped, as if it had not stopped, and only what is new counts as taken.
TEST(PilotRuns, TheFrameGoesOn) {
  PilotCase pilot;
  const PilotFactory pilots = [&](const Config&, std::uint64_t, std::uint64_t, std::uint64_t) {
    return pilot.scene.new_workload();
  };
  const SearchedRun searched{pilot.run, kPilotRays};
  const cycle::CycleResult& run = *pilot.run.cycle;
  const SearchObserver nobody;
  for (const std::size_t threads : {1, 2}) {
    const RunOptions options = on_threads(threads);
    PilotRuns runs(pilot.scene.accel(pilot.machines[0].bvh), pilot.scene.size(), pilots, searched,
                   slots_of(pilot.machines[0]), options, nobody);
    const FrameBeginning third = beginning_of(run, 0.3), most = beginning_of(run, 0.7);
    const auto taken = [&](double part, std::uint64_t rays) {
      return std::max(part, static_cast<double>(rays) / static_cast<double>(pilot.run.rays_completed));
    };
    runs.begin_frame(third.rays);
    const cycle::CycleResult part = runs.go_on(pilot.machines[0], third);
    EXPECT_TRUE(runs.complete()) << "nobody has interrupted it";
    EXPECT_GE(part.progress.back().completed, third.rays);
    EXPECT_LT(part.progress.back().completed, most.rays);
    EXPECT_NEAR(gain_by_beginning(run, part, third, 0).value, 0, 0.1);
    EXPECT_NEAR(runs.taken(), taken(0.3, part.progress.back().completed), 1e-12);
    runs.begin_frame(most.rays - third.rays);
    const cycle::CycleResult further = runs.go_on(pilot.machines[0], most);
    EXPECT_NEAR(runs.taken(), taken(0.7, further.progress.back().completed), 1e-12);
    for (const cycle::ProgressSample& sample : part.progress)
      EXPECT_EQ(at_count(further, sample.completed, cycle_of), static_cast<double>(sample.at));
    EXPECT_EQ(runs.go_on(pilot.machines[0], {1, pilot.run.rays_completed}).cycles, run.cycles);
    EXPECT_NEAR(runs.taken(), 1, 1e-12);
    EXPECT_EQ(runs.simulated_rays(), pilot.run.rays_completed);
  }
}

// A pilot with fewer paths than one and a half times the ray slots has as many further ones, and ends before these.
TEST(PilotRuns, ASmallPilotEndsWhileTheMachineIsFull) {
  PilotCase pilot;
  std::vector<std::uint64_t> further;
  const PilotFactory pilots = [&](const Config&, std::uint64_t, std::uint64_t more, std::uint64_t) {
    further.push_back(more);
    return pilot.scene.new_workload();
  };
  const SearchedRun searched{pilot.run, 4 * kPilotRays};
  const RunOptions options = on_threads(1);
  const SearchObserver nobody;
  const std::uint64_t slots = slots_of(pilot.machines[0]), few = slots, many = 2 * slots;
  PilotRuns runs(pilot.scene.accel(pilot.machines[0].bvh), pilot.scene.size(), pilots, searched, slots, options,
                 nobody);
  runs.begin("pilot", 1, many);
  EXPECT_TRUE(runs.drains());
  EXPECT_EQ(runs.simulate({&pilot.machines[0]}).front().rays_completed, pilot.run.rays_completed);
  runs.begin("pilot", 1, few);
  EXPECT_FALSE(runs.drains());
  const RunResult part = runs.simulate({&pilot.machines[0]}).front();
  const std::uint64_t stands_for = pilot.run.rays_completed * few / (4 * kPilotRays);
  EXPECT_GE(part.rays_completed, stands_for);
  EXPECT_LT(part.rays_completed, pilot.run.rays_completed);
  EXPECT_FALSE(part.cycle->all_begun) << "it was full";
  EXPECT_LE(runs.cycles(*part.cycle), static_cast<double>(part.cycle->cycles));
  EXPECT_EQ(runs.simulate_to_the_end({&pilot.machines[0]}).front().rays_completed, pilot.run.rays_completed);
  EXPECT_FALSE(runs.drains());
  EXPECT_EQ(further, (std::vector<std::uint64_t>{0, slots, 0}));
  EXPECT_TRUE(runs.complete()) << "nobody has interrupted it";
}

std::uint64_t misses(const RunResult& run) {
  std::uint64_t sum = 0;
  for (const cycle::TileResult& tile : run.cycle->tiles) sum += tile.shapes.misses;
  return sum;
}

// The run's shape buffers hold all shapes that its rays need, and a machine that begins with them fetches none. A
// buffer of a quarter of the room holds part of them, and one of the full room then finds the rest with the others.
TEST(PilotRuns, BeginWithTheShapesOfTheRunsBuffers) {
  PilotCase pilot;
  Config config = pilot.machines[0], small = config;
  config.memory.shape_buffer_kib = 256;
  small.memory.shape_buffer_kib = 4;
  const accel::Accel& accel = pilot.scene.accel(config.bvh);
  const auto run = [&](const Config& machine, const cycle::WarmCaches& warm) {
    RunOptions options = on_threads(1);
    options.warm = warm;
    ScatterWorkload workload = pilot.scene.workload();
    return run_cycle(machine, accel, pilot.scene.size(), workload, options);
  };
  const RunResult cold = run(config, {});
  const cycle::BufferShapes& all = cold.cycle->buffered;
  ASSERT_GT(misses(cold), 100u);
  EXPECT_EQ(misses(run(config, {.part = 1, .buffers = &all})), 0u);
  EXPECT_EQ(run(config, {.part = 0, .buffers = &all}).cycle->cycles, cold.cycle->cycles);
  const std::uint64_t half = misses(run(config, {.part = 0.5, .buffers = &all}));
  EXPECT_GT(half, misses(cold) / 4);
  EXPECT_LT(half, misses(cold) * 3 / 4);
  cycle::BufferShapes only(all.size());
  only.at(1) = all.at(1);
  EXPECT_LT(run(config, {.part = 1, .buffers = &only}).cycle->tiles[1].shapes.misses,
            cold.cycle->tiles[1].shapes.misses / 2);
  const RunResult narrow = run(small, {});
  cycle::BufferShapes own = narrow.cycle->buffered, of_first = own;
  of_first.at(1).clear();
  EXPECT_LT(run(config, {.part = 1, .buffers = &of_first}).cycle->tiles[1].shapes.misses,
            cold.cycle->tiles[1].shapes.misses * 9 / 10);
  EXPECT_LT(misses(run(small, {.part = 1, .buffers = &own})), misses(narrow));
}

std::uint64_t own_misses(const RunResult& run) {
  return run.cycle->own_caches->misses;
}

// All shapes fit into the resources' own caches, and a machine that begins with what these held fetches nothing.
TEST(PilotRuns, BeginWithTheLinesOfTheRunsOwnCaches) {
  PilotCase pilot;
  Config config = pilot.machines[0];
  config.memory.l1_kib = 64;
  config.memory.shape_buffer_kib = 2;
  const accel::Accel& accel = pilot.scene.accel(config.bvh);
  const auto run = [&](const cycle::WarmCaches& warm) {
    RunOptions options = on_threads(1);
    options.warm = warm;
    ScatterWorkload workload = pilot.scene.workload();
    return run_cycle(config, accel, pilot.scene.size(), workload, options);
  };
  const RunResult cold = run({});
  const cycle::CacheLines& all = cold.cycle->own_recent;
  ASSERT_EQ(all.size(), 2u);
  ASSERT_GT(own_misses(cold), 100u);
  EXPECT_EQ(own_misses(run({.part = 1, .own = &all})), 0u);
  const std::uint64_t half = own_misses(run({.part = 0.5, .own = &all}));
  EXPECT_GT(half, own_misses(cold) / 4);
  EXPECT_LT(half, own_misses(cold) * 3 / 4);
  const SearchedRun searched{cold, 8 * kPilotRays};
  const PilotFactory pilots = [&](const Config&, std::uint64_t, std::uint64_t, std::uint64_t) {
    return pilot.scene.new_workload();
  };
  const RunOptions plain = on_threads(1);
  const SearchObserver nobody;
  PilotRuns runs(accel, pilot.scene.size(), pilots, searched, slots_of(pilot.machines[0]), plain, nobody);
  runs.begin("pilot", 1, kPilotRays);
  EXPECT_LT(own_misses(runs.simulate({&config}).front()), own_misses(cold) / 4);
}

// An L2 of 4 KiB tells with its lines those that it replaced. Most of what one with twice the room holds at the end of
// the same run is among them, and a machine with the same room begins as it would without them.
TEST(PilotRuns, ALargerCacheBeginsWithLinesThatTheRunsReplaced) {
  PilotCase pilot;
  Config small = pilot.machines[0], large = small;
  small.memory.l2_kib = 4;
  large.memory.l2_kib = 8;
  small.memory.shape_buffer_kib = large.memory.shape_buffer_kib = 2;
  const accel::Accel& accel = pilot.scene.accel(small.bvh);
  const auto run = [&](const Config& machine, const cycle::CacheLines* lines) {
    RunOptions options = on_threads(1);
    options.warm = {.lines = lines, .part = 1};
    ScatterWorkload workload = pilot.scene.workload();
    return std::move(*run_cycle(machine, accel, pilot.scene.size(), workload, options).cycle);
  };
  const cycle::CacheLines recent = run(small, nullptr).recent_lines;
  cycle::CacheLines held = recent;
  const std::size_t room = 4 * 1024 / 64;
  ASSERT_GT(recent.front().size(), room) << "with lines that were replaced";
  EXPECT_LE(recent.front().size(), 2 * room);
  held.front().erase(held.front().begin(), held.front().end() - room);
  std::vector<std::uint64_t> of_large = run(large, nullptr).recent_lines.front();
  of_large.erase(of_large.begin(), of_large.end() - 2 * room);
  const auto among = [&](const std::vector<std::uint64_t>& lines) {
    return std::count_if(of_large.begin(), of_large.end(), [&](std::uint64_t line) {
      return std::find(lines.begin(), lines.end(), line) != lines.end();
    });
  };
  EXPECT_GT(among(recent.front()), among(held.front()) * 5 / 4);
  EXPECT_EQ(run(small, &recent).cycles, run(small, &held).cycles);
  EXPECT_NE(run(large, &recent).cycles, run(large, &held).cycles);
}

TEST(PilotRuns, HandOnAnError) {
  PilotCase pilot;
  std::atomic<int> begun{0};
  const PilotFactory pilots = [&](const Config&, std::uint64_t, std::uint64_t, std::uint64_t) {
    if (++begun == 2) throw std::runtime_error("no such pilot");
    return pilot.scene.new_workload();
  };
  EXPECT_THROW(pilot.simulate(3, pilots, {}), std::runtime_error);
}

}  // namespace
}  // namespace carousel::ringbus
