// The gain that the beginning of a frame foretells, on runs whose whole gain is known in closed form.
#include "ringbus/verdict/frame_beginning.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace carousel::ringbus {
namespace {

/// A run of stretches, in each of which a ray takes so many cycles, of which shading is busy for a part.
struct Stretch {
  std::uint64_t rays = 0;
  Cycle each = 0;
  double shading = 0;
};

cycle::CycleResult run_of(const std::vector<Stretch>& stretches) {
  cycle::CycleResult out;
  std::uint64_t completed = 0;
  double busy = 0;
  for (const Stretch& stretch : stretches)
    for (std::uint64_t ray = 0; ray < stretch.rays; ++ray) {
      out.cycles += stretch.each;
      busy += stretch.shading * static_cast<double>(stretch.each);
      out.progress.push_back({out.cycles, ++completed, {static_cast<Cycle>(busy)}});
    }
  out.uses = {{"shading", 1, static_cast<Cycle>(busy)}};
  return out;
}

double width(const Estimate& gain) {
  return gain.high - gain.low;
}

TEST(FrameBeginning, IsThatOfTheRunsTime) {
  const cycle::CycleResult run = run_of({{100, 10, 1}, {100, 30, 0}});  // 1,000 and 3,000 cycles
  EXPECT_EQ(beginning_of(run, 0.25).rays, 100u);
  EXPECT_EQ(beginning_of(run, 0.625).rays, 150u);
  EXPECT_EQ(beginning_of(run, 1).rays, 200u);
  EXPECT_NEAR(part_of(run, 50), 0.125, 1e-12);
  EXPECT_NEAR(part_of(run, 150), 0.625, 1e-12);
}

// All rays take half the time: 100 %, whichever part is known. The rest may be off by 5 points of time, more for a
// short beginning, though all blocks are alike.
TEST(FrameBeginning, AnEvenGainIsThatOfTheFrame) {
  const cycle::CycleResult run = run_of({{1000, 20, 0.5}}), relaxed = run_of({{1000, 10, 0.5}});
  for (const double part : {0.2, 0.5}) {
    const Estimate gain = gain_by_beginning(run, relaxed, beginning_of(run, part), 0);
    EXPECT_NEAR(gain.value, 1, 0.06) << part;
    EXPECT_LT(gain.low, 1);
    EXPECT_GT(gain.high, 1);
    const double off = 1 / (1 + gain.low) - 1 / (1 + gain.value);
    EXPECT_NEAR(off, (1 - part) * (0.05 * std::pow(0.3 / part, 0.3) + 0.01), 0.01) << part;
  }
}

// The relaxed machine saves half of the time of rays that are mostly shaded, and none of the others. The beginning has
// both kinds in equal numbers, and the rest only those that gain nothing: 16,000 of 24,000 cycles are left as they
// were.
TEST(FrameBeginning, TheRestTakesWhatBlocksTookThatWereAsBusy) {
  std::vector<Stretch> stretches, faster;
  for (int i = 0; i < 8; ++i) {
    stretches.insert(stretches.end(), {{50, 10, 0.9}, {50, 10, 0.1}});
    faster.insert(faster.end(), {{50, 5, 0.9}, {50, 10, 0.1}});
  }
  stretches.push_back({1600, 10, 0.1});
  faster.push_back({1600, 10, 0.1});
  const cycle::CycleResult run = run_of(stretches), relaxed = run_of(faster);
  const double real = static_cast<double>(run.cycles) / static_cast<double>(relaxed.cycles) - 1;
  EXPECT_NEAR(real, 24.0 / 22 - 1, 1e-12);
  const Estimate gain = gain_by_beginning(run, relaxed, beginning_of(run, 1.0 / 3), 0);
  EXPECT_NEAR(gain.value, real, 0.04) << "all of the rest as the beginning: 33 %";
  EXPECT_LE(gain.low, real);
  EXPECT_GE(gain.high, real);
}

// A third of shading, and then none: a beginning within the first third knows nothing of the rest.
TEST(FrameBeginning, TellsOfARestThatItsBlocksAreLike) {
  const cycle::CycleResult run = run_of({{800, 10, 0.9}, {1600, 10, 0.1}});
  EXPECT_FALSE(tells_of_rest(run, 0.2, 0));
  EXPECT_TRUE(tells_of_rest(run, 0.5, 0));
  EXPECT_TRUE(tells_of_rest(run_of({{2400, 10, 0.9}}), 0.2, 0));
  EXPECT_GT(unknown_rest(run, beginning_of(run, 0.25), 0), 0.8);
  EXPECT_LT(unknown_rest(run, beginning_of(run, 0.5), 0), 0.1);
}

TEST(FrameBeginning, TakesSoMuchOfCyclesAndOfRays) {
  const cycle::CycleResult run = run_of({{100, 10, 1}, {100, 30, 0}});  // half of the rays in a quarter of the time
  EXPECT_NEAR(part_that_takes(run, 200, 0.5), 0.25, 1e-12);
  EXPECT_EQ(part_that_takes(run, 200, 1.2), 1);
  EXPECT_EQ(part_that_takes(run, 200, -0.1), 0);
}

// Rest that is like no block of the beginning may take any time.
TEST(FrameBeginning, AnUnlikeRestWidensTheInterval) {
  const cycle::CycleResult run = run_of({{800, 10, 0.9}, {1600, 10, 0.1}}),
                           alike = run_of({{800, 10, 0.9}, {1600, 10, 0.9}}),
                           relaxed = run_of({{800, 5, 0.9}, {1600, 10, 0.1}});
  const FrameBeginning third = beginning_of(run, 1.0 / 3);
  const Estimate unlike = gain_by_beginning(run, relaxed, third, 0), like = gain_by_beginning(alike, relaxed, third, 0);
  EXPECT_GT(width(unlike), 5 * width(like));
  EXPECT_LE(unlike.low, 24.0 / 20 - 1) << "what it is in truth";
}

// Later blocks of the beginning save more than earlier ones: a trend, which neighbours hardly differ by.
TEST(FrameBeginning, ATrendWidensTheInterval) {
  std::vector<Stretch> growing;
  for (Cycle i = 0; i < 16; ++i) growing.push_back({100, 60 - 2 * i, 0.5});
  const cycle::CycleResult run = run_of({{3200, 60, 0.5}}), trend = run_of(growing), level = run_of({{1600, 45, 0.5}});
  const FrameBeginning half = beginning_of(run, 0.5);
  const Estimate now = gain_by_beginning(run, trend, half, 0), still = gain_by_beginning(run, trend, half, 0, true);
  EXPECT_GT(width(now), 3.5 * width(gain_by_beginning(run, level, half, 0)));
  EXPECT_GT(still.high, now.high + 0.1) << "room for shapes may go on filling";
  EXPECT_EQ(still.low, now.low);
}

// While it fills, which takes the first fifth of the beginning, the relaxed machine saves nothing, and then half of the
// time: 100 %, less what it takes to fill.
TEST(FrameBeginning, WhatAFillingMachineTakesSaysNothingOfTheRest) {
  const cycle::CycleResult run = run_of({{2000, 10, 0.5}}), relaxed = run_of({{200, 10, 0.5}, {800, 5, 0.5}});
  const FrameBeginning half = beginning_of(run, 0.5);
  const double known = gain_by_beginning(run, relaxed, half, 220).value;
  EXPECT_NEAR(known, 20000 / (2000 + 9000.0) - 1, 0.05);
  EXPECT_GT(known, gain_by_beginning(run, relaxed, half, 0).value + 0.01);
}

}  // namespace
}  // namespace carousel::ringbus
