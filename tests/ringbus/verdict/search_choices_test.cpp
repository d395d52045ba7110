// What the search for the bottleneck makes of gains and of the run's ledger: in closed form, without a simulation.
#include "ringbus/verdict/search_choices.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "ringbus/verdict/frame_race.h"
#include "ringbus/verdict/pilot_likeness.h"

namespace carousel::ringbus {
namespace {

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

// Collections that wait for an idle resource, instead of going ahead, gain nothing in hundreds of machines; those that
// go ahead hide latencies.
TEST(SearchChoices, WhatSeldomGainsIsInNoGroup) {
  WhatIf rule;
  rule.part.part = "issue_rule";
  rule.relaxed.collections.partial = Partial::kIdle;
  EXPECT_TRUE(search_groups({rule}, run_of(0, 0, 0)).empty());
  rule.relaxed.collections.partial = Partial::kAhead;
  EXPECT_EQ(search_groups({rule}, run_of(0, 0, 0)).size(), 1u);
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

// A rival reaches its upper end seldom: 64 % of the way to it, and 3 points for a tie, are looked at.
TEST(FrameRace, AClassMayBeBeatenByWhatMayGainMoreThanATie) {
  std::vector<Gain> gains{relaxed_alone(0.4, 0.3, 0.5), relaxed_alone(0.3, -0.1, 0.42), relaxed_alone(0.3, 0.1, 0.5)};
  EXPECT_FALSE(may_be_beaten(gains, 0)) << "43 % at most";
  gains[2].high = 0.51;
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

// Nothing may beat the class to be named. It is looked at alone where it is told roughly, or where only a pilot tells
// of it that may be wrong about it.
TEST(FrameRace, AWinnerIsLookedAtWhereItIsHardlyKnown) {
  const auto next = [](Gain named, bool alike = true, bool unsure = false) {
    return next_look({named, relaxed_alone(0.02, 0, 0.04)}, alike, [&](std::size_t) { return unsure; });
  };
  Gain named = relaxed_alone(0.4, 0.2, 0.6);
  EXPECT_FALSE(next(named));
  EXPECT_EQ(next(named, false), 0u) << "the pilot is not like the run";
  EXPECT_EQ(next(named, true, true), 0u);
  EXPECT_EQ(next(relaxed_alone(0.2, -0.05, 0.45)), 0u) << "it may gain nothing";
  EXPECT_EQ(next(relaxed_alone(0.4, 0.07, 0.73)), 0u) << "told within 66 points";
  named.frame = 0.16;
  EXPECT_FALSE(next(named, true, true));
  const auto none = [](std::size_t) { return false; };
  EXPECT_EQ(next_look({relaxed_alone(0.2, -0.05, 0.45), relaxed_alone(0, -0.3, 1)}, false, none), 1u)
      << "more may be gained by what a pilot says nothing of";
  EXPECT_EQ(next_look({relaxed_alone(0.2, 0.05, 0.35), relaxed_alone(0, -0.3, 1)}, false, none), 0u);
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

// The greatest of uncertain gains is likely to be overestimated: 40 % (30 to 50 %) is more than 42 % (10 to 74 %), and
// 6 % (1 to 10 %) more than 20 % (-30 to 70 %).
TEST(SearchChoices, TheNamedClassIsLikelyToGainMost) {
  EXPECT_EQ(named_gain({relaxed_alone(0.2, -0.3, 0.7), relaxed_alone(0.06, 0.01, 0.1)}), 1u);
  EXPECT_EQ(named_gain({relaxed_alone(0.2, -0.3, 0.7)}), 0u) << "it probably gains";
  EXPECT_FALSE(named_gain({relaxed_alone(0.2, -0.41, 0.81)}));
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
  EXPECT_TRUE(stands_out({gain}, 0.1)) << "it probably gains";
  gain.low = -1.01;
  EXPECT_FALSE(stands_out({gain}, 0.1));
}

}  // namespace
}  // namespace carousel::ringbus
