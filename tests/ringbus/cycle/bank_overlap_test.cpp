// Cycles in which any bank works, and in which none does while answers are awaited, counted cycle by cycle.
#include "ringbus/cycle/testers/bank_overlap.h"

#include <random>

#include <gtest/gtest.h>

#include "ringbus/cycle/testers/tester.h"
#include "tests/support/random_runs.h"

namespace carousel::ringbus::cycle {
namespace {

TEST(BankOverlap, IsWhatEachCycleSays) {
  for (int run = 0; run < scaled(60); ++run) {
    std::mt19937 random(run_seed() + static_cast<unsigned>(run));
    const auto pick = [&](unsigned least, unsigned most) { return least + random() % (most - least + 1); };
    const std::size_t count = pick(1, 4);
    const Cycle after = pick(0, 2);
    std::vector<UnitBank> banks;
    for (std::size_t b = 0; b < count; ++b)
      banks.emplace_back(TesterUnits{.units = static_cast<std::int64_t>(pick(1, 3)),
                                     .interval_cycles = static_cast<std::int64_t>(pick(1, 6)),
                                     .latency_cycles = static_cast<std::int64_t>(pick(1, 20))});
    BankOverlap overlap(after);
    std::vector<char> busy(4000), awaited(4000);
    TestingCycles taken;
    const auto advance = [&](Cycle now) {
      overlap.advance(now, [&](const auto& take) {
        for (const UnitBank& bank : banks) take(bank);
      });
    };
    Cycle now = 0;
    for (int step = 0; step < 80; ++step) {
      UnitBank& bank = banks[pick(0, unsigned(count) - 1)];
      const Cycle start = std::max(now + pick(0, 9), bank.free_at());
      bank.reserve(start, pick(1, 5));
      for (Cycle c = start; c < bank.free_at(); ++c) busy[c] = 1;
      Cycle until = bank.free_at() - bank.interval() + bank.latency();
      if (pick(0, 3) == 0) overlap.expect(start, until += pick(0, 40));  // answers that come one after another
      for (Cycle c = start; c < until + after; ++c) awaited[c] = 1;
      now += pick(0, 12);
      advance(now);
      if (pick(0, 1) == 0) {  // the banks forget, whether or not the cycles are taken
        for (UnitBank& other : banks) other.busy_before(now);
      }
      if (pick(0, 2) == 0) {
        const TestingCycles more = overlap.take();
        taken.any += more.any;
        taken.latency += more.latency;
      }
    }
    now += 300;
    advance(now);
    const TestingCycles more = overlap.take();
    TestingCycles expected;
    for (Cycle c = 0; c < now; ++c) {
      expected.any += busy[c];
      expected.latency += !busy[c] && awaited[c];
    }
    EXPECT_EQ(taken.any + more.any, expected.any) << "seed " << run_seed() << ", run " << run;
    EXPECT_EQ(taken.latency + more.latency, expected.latency) << "seed " << run_seed() << ", run " << run;
  }
}

// Eight steps of one ray go one after another through four units: all of their time is one wait for answers, whether a
// packet's rays are tested together or a ray by itself.
TEST(BankOverlap, StepsThatGoOneAfterAnotherAreWaitedFor) {
  TestersConfig config;
  config.units[UnitKind::kTriangle] = {1, 1, 10};
  config.units[UnitKind::kHitBuffer] = {4, 1, 6};
  IntersectionCounts counts;
  counts.triangle = 1;
  counts.buffer_steps = 8;
  for (const bool alone : {false, true}) {
    Tester tester(config);
    const Cycle end = alone ? tester.ray(5, counts) : tester.strip(5, counts, 1);
    EXPECT_EQ(end, 5u + 10 + 6 + 7);
    tester.account(TileState::kTesting, end);
    TileResult result;
    tester.fill_in(result);
    EXPECT_EQ(result.testing.any, 1u + 2);
    EXPECT_EQ(result.testing.any + result.testing.latency, end - 5) << alone;
  }
}

// A program is as long as its instructions, beside those of other rays.
TEST(BankOverlap, ProgramsAreWaitedFor) {
  TestersConfig config;
  config.units[UnitKind::kProcedural] = {8, 1, 4};
  IntersectionCounts counts;
  counts.procedural = counts.programs = 2;
  counts.program_cycles = 100;
  Tester tester(config);
  const Cycle end = tester.strip(3, counts, 2);
  EXPECT_EQ(end, 3u + 4 + 49);
  tester.account(TileState::kTesting, end);
  TileResult result;
  tester.fill_in(result);
  EXPECT_EQ(result.testing.any, 13u);
  EXPECT_EQ(result.testing.any + result.testing.latency, end - 3);
}

}  // namespace
}  // namespace carousel::ringbus::cycle
