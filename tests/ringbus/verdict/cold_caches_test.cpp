#include "ringbus/verdict/cold_caches.h"

#include <gtest/gtest.h>

#include "ringbus/cycle/memory/touched_lines.h"

namespace carousel::ringbus {
namespace {

TEST(ColdCaches, ReadsAreCountedBetweenFillAndDrain) {
  cycle::CycleResult result;
  result.memory.lines = 900;
  result.first_reads = 400;
  // 10 slots are filled by 20 rays.
  result.progress = {{100, 10, {}, 200, 200}, {200, 20, {}, 300, 280}, {300, 60, {}, 700, 380}};
  EXPECT_EQ(reads_between(result, 10).reads, 900u);  // it is not known when the drain began
  result.all_begun = cycle::ProgressSample{300, 60, {}, 700, 380};
  EXPECT_EQ(reads_between(result, 10).reads, 400u);
  EXPECT_EQ(reads_between(result, 10).first, 100u);
  EXPECT_DOUBLE_EQ(reads_between(result, 10).first_share(), 0.25);
  EXPECT_EQ(reads_between(result, 40).reads, 900u);  // there is no time between
  EXPECT_EQ(MemoryReads{}.first_share(), 0);
}

TEST(ColdCaches, ALineIsNewOnce) {
  cycle::TouchedLines lines;
  for (const std::uint64_t line : {0ull, 1ull, 63ull, 64ull, 4095ull, 4096ull, 1ull << 50, (1ull << 50) + 1}) {
    EXPECT_TRUE(lines.insert(line)) << line;
    EXPECT_FALSE(lines.insert(line)) << line;
  }
  EXPECT_FALSE(lines.insert(1));
}

// Memory limits 80 of 100 cycles, and a quarter of that is first reads: of 80 cycles 60 are left to it, of which more
// of it saves 30. Another class saves 25 in both frames, or 35.
TEST(ColdCaches, MemoryMayGainMostWithoutFirstReads) {
  const WarmGain memory{0.4 / 0.6, 0.3};
  const auto saves = [](double part) { return WarmGain{part / (1 - part), 0}; };
  EXPECT_TRUE(best_when_warm(memory, 0.25, {saves(0.25)}));
  EXPECT_FALSE(best_when_warm(memory, 0.25, {saves(0.25), saves(0.35)}));
  EXPECT_TRUE(best_when_warm(memory, 0.25, {saves(0.299)}));
  EXPECT_FALSE(best_when_warm(memory, 0.25, {saves(0.301)}));
  EXPECT_FALSE(best_when_warm(memory, 1, {})) << "nothing is left";
  EXPECT_FALSE(best_when_warm({memory.gain, -0.01}, 0.25, {})) << "it may gain nothing";
}

TEST(ColdCaches, OnlyTheWayToMemoryGainsByThem) {
  EXPECT_TRUE(gains_of_cold_caches("memory_bandwidth"));
  EXPECT_TRUE(gains_of_cold_caches("memory_latency"));
  for (const char* part : {"shading", "l2_size", "box_tests", ""}) EXPECT_FALSE(gains_of_cold_caches(part)) << part;
}

}  // namespace
}  // namespace carousel::ringbus
