// Simulations of pilots on several threads: the same results in the same order as on one, progress told by one thread
// at a time, and an error of one simulation reaches the caller. Small enough for ThreadSanitizer.
#include "ringbus/verdict/pilot_runs.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/verdict/frame_race.h"
#include "ringbus/verdict/pilot_likeness.h"
#include "ringbus/verdict/progress_blocks.h"
#include "ringbus/verdict/search_choices.h"
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

cycle::CycleResult run_of(double shading_busy, Cycle memory, Cycle latency) {
  cycle::CycleResult out;
  out.cycles = 1000;
  out.uses = {{"shading", 4, static_cast<Cycle>(4000 * shading_busy)}, {"l2_port", 2, 1800}};
  out.tiles.resize(2);
  for (cycle::TileResult& tile : out.tiles) {
    tile.states[static_cast<std::size_t>(cycle::TileState::kMemory)] = memory;
    tile.testing.latency = latency;
  }
  return out;
}

// Busy for x of the time in the mean, and for twice that where it is worst: half of that is saved, 1 / (1 - x) - 1, and
// 3 % for the schedule.
TEST(LedgerBound, FollowsFromWhatPartsAreBusyWith) {
  EXPECT_NEAR(most_gain(run_of(0.2, 0, 0), "shading", false), 0.25 + 0.03, 1e-12);
  EXPECT_NEAR(most_gain(run_of(0, 0, 0), "shading", false), 0.03, 1e-12);
  EXPECT_NEAR(most_gain(run_of(0.5, 0, 0), "shading", false), 1 + 0.03, 1e-12) << "no part was busy for longer";
  EXPECT_NEAR(most_gain(run_of(0.9, 0, 0), "shading", false), 1 + 0.03, 1e-12);
  EXPECT_EQ(most_gain(run_of(0, 0, 0), "contexts", false), std::numeric_limits<double>::infinity());
}

TEST(LedgerBound, FollowsFromWhatResourcesWaitFor) {
  // Of 100 cycles that a resource waits, others wait for 50 more; the 200 that tests take may hide such waits.
  EXPECT_NEAR(most_gain(run_of(0, 100, 0), "memory_latency", false), 0.15 / 0.85 + 0.03, 1e-12);
  EXPECT_NEAR(most_gain(run_of(0, 100, 200), "memory_latency", false), 0.35 / 0.65 + 0.03, 1e-12);
  EXPECT_NEAR(most_gain(run_of(0, 100, 200), "test_latency", false), 0.3 / 0.7 + 0.03, 1e-12);
  EXPECT_NEAR(most_gain(run_of(0, 100, 200), "packets_in_flight", false), 0.03, 1e-12);
  EXPECT_NEAR(most_gain(run_of(0, 100, 200), "l2_port", false), 0.35 / 0.65 + 0.03, 1e-12)
      << "busy for 90 %, seldom waited for";
  cycle::CycleResult warps = run_of(0, 0, 0);
  warps.tiles[1].warps.emplace();
  EXPECT_EQ(most_gain(warps, "memory_latency", false), std::numeric_limits<double>::infinity());
}

// Of four pools one is busy for 700 of 1,000 cycles, and the others for 20. Twice its workers save half of that.
TEST(LedgerBound, FollowsFromTheBusiestPart) {
  cycle::CycleResult run = run_of(0, 0, 0);
  cycle::ClassUse& pools = run.uses.front();
  pools = {"shading"};
  pools.count(2, 1400);
  for (int i = 0; i < 3; ++i) pools.count(4, 80);
  EXPECT_EQ(pools.parts, 14);
  EXPECT_EQ(pools.busy, 1640u);
  EXPECT_NEAR(most_gain(run, "shading", false), 0.35 / 0.65 + 0.03, 1e-12);
  run.tiles.resize(10);
  run.tiles.front().states[static_cast<std::size_t>(cycle::TileState::kMemory)] = 900;
  EXPECT_NEAR(most_gain(run, "memory_latency", false), 0.45 / 0.55 + 0.03, 1e-12) << "one resource of ten waits";
}

// The data wires of DRAM are busy for a third of the time, but its banks limit: twice the channels gain 106 %.
TEST(LedgerBound, OfDramIsNotThatOfItsData) {
  cycle::CycleResult run = run_of(0, 900, 0);
  run.uses.push_back({"memory_bandwidth", 1, 330});
  EXPECT_NEAR(most_gain(run, "memory_bandwidth", false), 0.33 / 0.67 + 0.03, 1e-12) << "of a pipe";
  run.dram.emplace();
  EXPECT_EQ(most_gain(run, "memory_bandwidth", false), std::numeric_limits<double>::infinity());
}

// Shading takes 800 of the run's 1,000 cycles, whatever else is relaxed.
TEST(LedgerBound, FollowsFromTheWorkOfOthers) {
  const cycle::CycleResult run = run_of(0.8, 900, 900);
  for (const char* part : {"contexts", "memory_latency", "ray_slots"}) {
    EXPECT_NEAR(most_gain(run, part, true), 0.25 + 0.03, 1e-12) << part;
    EXPECT_GT(most_gain(run, part, false), 1) << "its work is not known: " << part;
  }
  EXPECT_NEAR(most_gain(run, "shading", true), 1 + 0.03, 1e-12) << "l2_port's work is not fixed";
  Config config;
  cycle::CycleResult plain = run;
  plain.uses.push_back({"bundle_tests", 2, 0});
  EXPECT_TRUE(work_is_fixed(config, plain));
  config.shading.lanes = 4;
  EXPECT_FALSE(work_is_fixed(config, plain));
  config = {};
  plain.uses.back().busy = 1;
  EXPECT_FALSE(work_is_fixed(config, plain)) << "rays that are tested together";
}

// The memory is busy for 800 of 1,000 cycles. Half of its lines are read for the first time, which takes 400 of them,
// with any caches.
TEST(LedgerBound, FollowsFromFirstReads) {
  cycle::CycleResult run = run_of(0, 900, 900);
  run.uses.push_back({"memory_bandwidth", 1, 800});
  run.memory.lines = 1000;
  run.first_reads = 500;
  EXPECT_NEAR(most_gain(run, "memory_latency", false), 1 / 0.4 - 1 + 0.03, 1e-12);
  EXPECT_NEAR(most_gain(run, "contexts", false), 1 / 0.4 - 1 + 0.03, 1e-12);
  EXPECT_NEAR(most_gain(run, "memory_bandwidth", false), 1 + 0.03, 1e-12) << "which reads them faster";
  run.first_reads = 0;
  EXPECT_GT(most_gain(run, "contexts", false), 100);
}

// A part that differs by 15 points or less is borne with; of two such, or of one that differs by more, those count that
// matter.
TEST(PilotLikeness, OnlyAPartThatMattersVetoesAnAnswer) {
  Likeness off;
  off.parts = {{"memory_bandwidth", 0.55, 0.3}};
  const auto matters = [](std::string_view) { return true; };
  const auto shading_does = [](std::string_view part) { return part == "shading"; };
  EXPECT_EQ(off.veto(matters), "its memory_bandwidth is 55 % busy, and the run's 30 %");
  EXPECT_EQ(off.veto(shading_does), "");
  EXPECT_NEAR(off.off(), 0.25, 1e-12) << "by which gains may be off";
  off.parts = {{"memory_bandwidth", 0.4, 0.3}, {"shading", 0.8, 0.9}};
  EXPECT_EQ(off.veto(matters), "its shading is 80 % busy, and the run's 90 %");
  EXPECT_EQ(off.veto(shading_does), "");
  off.cycles = 97575;
  off.deviation = 0.365;
  off.other_cycles = true;
  EXPECT_EQ(off.veto(shading_does), "it foretells 97575 cycles for the frame, -26.7 % of the run's");
}

TEST(SearchChoices, WhatLosesInAPilotMayGainAsMuchInTheFrame) {
  EXPECT_EQ(gain_beyond({0.1, 0, 0.2}, "l2_size"), 0);
  EXPECT_EQ(gain_beyond({-0.1, -0.2, 0}, "l2_size"), 0.1);
  EXPECT_EQ(gain_beyond({-0.2, -0.3, -0.1}, "l2_size"), 1.1) << "up to 100 %";
  EXPECT_EQ(gain_beyond({-0.2, -0.3, -0.1}, "issue_rule"), 0.2) << "another rule may lose";
}

TEST(SearchChoices, APilotSaysLittleOfMoreSlots) {
  const Estimate gain = of_few_slots({0.5, 0.1, 1.1});
  EXPECT_EQ(gain.value, 0.5);
  EXPECT_NEAR(gain.low, 0.5 - 0.5, 1e-12) << "a right angle of 0.4 and 0.3";
  EXPECT_NEAR(gain.high, 0.5 + std::hypot(0.6, 0.3), 1e-12);
}

Gain relaxed_alone(double value, double low, double high) {
  Gain gain;
  gain.gain = value;
  gain.low = low;
  gain.high = high;
  return gain;
}

// A rival reaches its upper end seldom: seven tenths of the way to it, and 3 points for a tie, are looked at.
TEST(FrameRace, AClassMayBeBeatenByWhatMayGainMoreThanATie) {
  std::vector<Gain> gains{relaxed_alone(0.4, 0.3, 0.5), relaxed_alone(0.3, -0.1, 0.42), relaxed_alone(0.3, 0.1, 0.48)};
  EXPECT_FALSE(may_be_beaten(gains, 0));
  gains[2].high = 0.49;
  EXPECT_TRUE(may_be_beaten(gains, 0));
  gains[2].together = 2;
  EXPECT_FALSE(may_be_beaten(gains, 0)) << "several gain less together";
  gains[2].gain = 0.44;
  EXPECT_TRUE(may_be_beaten(gains, 0)) << "one of several may gain as much";
  gains[2].together = 0;
  EXPECT_FALSE(may_be_beaten(gains, 0)) << "nobody has simulated it";
}

// The frame is simulated for the class to be named and its first rival: where less of it is known, and else for the
// wider interval. What is known of the whole frame needs nothing more.
TEST(FrameRace, GoesOnWhereLessIsKnown) {
  std::vector<Gain> gains{relaxed_alone(0.4, 0.3, 0.5), relaxed_alone(0.35, 0.1, 0.6), relaxed_alone(0.1, 0, 0.45)};
  EXPECT_EQ(next_contender(gains), 1u) << "its interval is wider";
  gains[1].frame = 0.16;
  EXPECT_EQ(next_contender(gains), 0u);
  gains[0].frame = 0.32;
  EXPECT_EQ(next_contender(gains), 1u);
  gains[1].frame = 1;
  EXPECT_EQ(next_contender(gains), 2u) << "the next rival";
  gains[2].high = 0.2;
  EXPECT_FALSE(next_contender(gains)) << "none may be named instead";
  gains[0].frame = 1;
  EXPECT_FALSE(next_contender(gains));
  gains = {relaxed_alone(0.4, -0.3, 1.1), relaxed_alone(0.1, -0.1, 0.3)};
  EXPECT_EQ(next_contender(gains), 0u) << "none is to be named yet";
}

TEST(FrameRace, DoublesThePartOfTheFrame) {
  cycle::CycleResult run;
  run.cycles = 10'000;
  for (std::uint64_t ray = 1; ray <= 1000; ++ray) run.progress.push_back({10 * ray, ray, {5 * ray}});
  run.uses = {{"shading", 1, 5000}};
  EXPECT_EQ(next_part(run, 0, 10, 1), 0.16);
  EXPECT_NEAR(next_part(run, 0, 100, 1), 0.3, 1e-12) << "three times what fills the machine";
  EXPECT_EQ(next_part(run, 0.16, 10, 1), 0.32);
  EXPECT_EQ(next_part(run, 0.64, 10, 1), 1);
  EXPECT_EQ(next_part(run, 0.2, 10, 0.35), 0.35) << "what is left";
  EXPECT_EQ(next_part(run, 0.2, 10, 0.29), 0) << "hardly more than is known";
  EXPECT_EQ(next_part(run, 0, 10, 0.15), 0);
}

// The greatest of uncertain gains is likely to be overestimated: 40 % (30 to 50 %) is more than 42 % (10 to 74 %).
TEST(SearchChoices, TheNamedClassIsLikelyToGainMost) {
  EXPECT_EQ(named_gain({relaxed_alone(0.42, 0.1, 0.74), relaxed_alone(0.4, 0.3, 0.5)}), 1u);
  EXPECT_EQ(named_gain({relaxed_alone(0.52, 0.2, 0.84), relaxed_alone(0.4, 0.3, 0.5)}), 0u);
}

// A pilot that tells nothing of a class may leave it most to gain.
TEST(FrameRace, TheMiddleOfTheIntervalSaysWhatIsLookedAtFirst) {
  const std::vector<Gain> gains{relaxed_alone(0.2, 0.1, 0.3), relaxed_alone(-0.4, -0.5, 1),
                                relaxed_alone(0.02, 0, 0.02)};
  EXPECT_EQ(worth_a_second_look(gains, 6), (std::vector<std::size_t>{1, 0}));
  EXPECT_EQ(worth_a_second_look(gains, 1), std::vector<std::size_t>{1});
}

TEST(SearchChoices, AClassStandsOutUnlessCyclesAreFarOff) {
  Gain gain;
  gain.gain = 0.5;
  gain.low = 0.1;
  EXPECT_TRUE(stands_out({gain}, 0.39));
  EXPECT_TRUE(stands_out({gain}, -0.39));
  EXPECT_FALSE(stands_out({gain}, 0.41));
  EXPECT_FALSE(stands_out({gain}, -0.41));
  gain.frame = 0.2;
  EXPECT_TRUE(stands_out({gain}, 0.41)) << "no pilot told of it";
  gain.low = -0.01;
  EXPECT_FALSE(stands_out({gain}, 0.1));
}

}  // namespace
}  // namespace carousel::ringbus
