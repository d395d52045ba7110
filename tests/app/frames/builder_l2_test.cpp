// The unit that builds, with an L2 between it and the memory (`frames.builder.asks: l2`).
#include <algorithm>
#include <stop_token>
#include <vector>

#include <gtest/gtest.h>

#include "ringbus/cycle/builder/builder_unit.h"

namespace carousel::builder_l2_test {
namespace {

using namespace ringbus::cycle;
using Lines = std::vector<std::uint64_t>;

// Lines of 64 bytes. Lines 0 and 1 are read and line 0 written; then line 0 is read again, and half of line 2 written.
BuilderWork two_steps() {
  BuilderWork work;
  work.level(0).push_back({{{0, 64}, {64, 64}}, {{0, 64}}, 1, false});
  work.level(1).push_back({{{0, 64}}, {{128, 32}}, 1, false});
  return work;
}

BuilderUse use_of(MemoryConfig::Write write, Lines& cached, const std::stop_token& stop = {}) {
  BuilderConfig builder;
  builder.asks = BuilderConfig::Asks::kL2;
  MemoryConfig memory;
  memory.l2_write = write;
  const BuilderWork work = two_steps();
  const BuilderUse use = run_builder(builder, memory, 1000, work, stop, cached);
  std::sort(cached.begin(), cached.end());
  return use;
}

TEST(BuilderL2, KeepsWhatIsWrittenUntilTheBuilderIsDone) {
  Lines cached;
  const BuilderUse use = use_of(MemoryConfig::Write::kBack, cached);
  EXPECT_EQ(use.l2->hits, 1u);
  EXPECT_EQ(use.l2->write_fetches, 1u) << "the rest of line 2";
  EXPECT_EQ(use.l2->drained, 2u);
  EXPECT_EQ(use.memory.lines, 3u);
  EXPECT_EQ(use.memory.lines_written, 2u);
  EXPECT_EQ(cached, (Lines{0, 1, 2}));
  const BuilderUse again = use_of(MemoryConfig::Write::kBack, cached);
  EXPECT_EQ(again.memory.lines, 0u) << "all is there";
  EXPECT_EQ(again.memory.lines_written, 2u);
  EXPECT_LT(again.cycles, use.cycles);
}

TEST(BuilderL2, WritesThrough) {
  Lines cached{0};
  const BuilderUse use = use_of(MemoryConfig::Write::kThrough, cached);
  EXPECT_EQ(use.l2->hits, 2u);
  EXPECT_EQ(use.memory.lines, 1u);
  EXPECT_EQ(use.memory.lines_written, 2u);
  EXPECT_EQ(use.l2->drained, 0u);
  EXPECT_EQ(cached, (Lines{0, 1})) << "line 2 takes no room";
}

TEST(BuilderL2, LeavesNothingThereIfItIsStopped) {
  std::stop_source source;
  source.request_stop();
  Lines cached{0, 7};
  EXPECT_FALSE(use_of(MemoryConfig::Write::kBack, cached, source.get_token()).complete);
  EXPECT_EQ(cached, Lines{});
}

}  // namespace
}  // namespace carousel::builder_l2_test
