// Cycles in which any bank works, and in which none does while answers are awaited, counted cycle by cycle.
#include "ringbus/cycle/testers/bank_overlap.h"

#include <random>

#include <gtest/gtest.h>

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
      for (Cycle c = start; c < bank.free_at() - bank.interval() + bank.latency() + after; ++c) awaited[c] = 1;
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

}  // namespace
}  // namespace carousel::ringbus::cycle
