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

TEST(ColdCaches, OnlyTheWayToMemoryGainsByThem) {
  EXPECT_TRUE(gains_of_cold_caches("memory_bandwidth"));
  EXPECT_TRUE(gains_of_cold_caches("memory_latency"));
  for (const char* part : {"shading", "l2_size", "box_tests", ""}) EXPECT_FALSE(gains_of_cold_caches(part)) << part;
}

}  // namespace
}  // namespace carousel::ringbus
