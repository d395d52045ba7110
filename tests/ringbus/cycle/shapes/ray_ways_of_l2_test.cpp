// An L2 with ways for rays and paths only, with answers on wires that have a width, and with answers for several
// resources: the test plays the resources and the memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/load/load.h"
#include "ringbus/cycle/shapes/shape_cache.h"
#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus::cycle {
namespace {

using testing::ElementsAre;

/// Two resources behind a cache of one KiB with two ways; a line of 64 bytes is looked up each cycle, and all ways take
/// a cycle.
struct TwoClients {
  explicit TwoClients(const std::string& more)
      : config(load_config({"scene: {builtin: cornell}\nengine: {kind: cycle}\nmemory: {l2_kib: 1, ways: 2, "
                            "l2_lines_per_cycle: 1, l2_latency_cycles: 2, dram_latency_cycles: 2, " +
                                more + "}\n",
                            "cache.yaml"})
                   .config.memory) {}

  /// Asks for a line at a time when the cache is idle, and brings it if the cache asks for it. Returns whether it was
  /// there.
  bool read(std::uint64_t line) {
    requests[0].send(now, {line, 1, 0});
    cache.run(now + 10);
    const bool there = down.next() == kNever;
    if (!there) up.send(now + 10, down.take());
    cache.run(now += 20);
    while (answers[0].next() != kNever) answers[0].take();
    return there;
  }

  MemoryConfig config;
  LooseChannel<FetchRequest> requests[2];
  LooseChannel<FetchAnswer> answers[2];
  LooseChannel<PushedShapes> pushed[2];
  LooseChannel<std::uint64_t> down, up;
  ShapeCache cache{
      config,
      std::vector<ShapeCache::Client>{{&requests[0], &answers[0], &pushed[0]}, {&requests[1], &answers[1], &pushed[1]}},
      down, up};
  Cycle now = 0;
};

// Eight sets: lines 0, 8, 16, ... share one. Rays and paths stand from 2^40 on.
TEST(L2RayWays, ShapesDoNotReplaceRays) {
  const std::uint64_t ray = (std::uint64_t{1} << 40) / 64;
  for (const int ways : {0, 1}) {
    TwoClients bench("l2_ray_ways: " + std::to_string(ways));
    EXPECT_FALSE(bench.read(ray));
    EXPECT_FALSE(bench.read(0));
    EXPECT_FALSE(bench.read(8));
    EXPECT_FALSE(bench.read(16));
    EXPECT_EQ(bench.read(ray), ways == 1);
    EXPECT_FALSE(bench.read(1));
    EXPECT_FALSE(bench.read(9));
    EXPECT_EQ(bench.read(1), ways == 0) << "one way is left to shapes";
  }
}

TEST(L2Answers, FollowOneAnotherOnWiresWithAWidth) {
  TwoClients bench("l2_answer_bytes_per_cycle: 16");
  bench.read(1);
  bench.read(2);
  bench.requests[0].send(1000, {1, 2, 7});  // both lines are looked up by 1002, and need eight cycles
  bench.requests[1].send(1000, {1, 1, 9});  // looked up by 1003, and waits for the wires until 1010
  bench.cache.run(2000);
  EXPECT_EQ(bench.answers[0].next(), 1010u);
  EXPECT_EQ(bench.answers[1].next(), 1014u);
}

TEST(L2Answers, GoToAllThatTheRequestNames) {
  TwoClients bench("l2_answer_bytes_per_cycle: 16");
  bench.read(1);
  FetchRequest request{1, 1, 7};
  request.skipped = 16;
  request.wanted = 40;
  request.others = 2;
  EXPECT_EQ(request.bytes(), 24u);
  bench.requests[0].send(1000, request);
  bench.cache.run(2000);
  EXPECT_EQ(bench.answers[0].next(), 1005u);  // looked up by 1001, four cycles, one more on the way
  ASSERT_EQ(bench.pushed[1].next(), 1005u);   // at the same time
  const PushedShapes shapes = bench.pushed[1].take();
  EXPECT_EQ(shapes.address, 64u + 16);
  EXPECT_EQ(shapes.bytes(), 40u);
  EXPECT_EQ(bench.pushed[0].next(), kNever);
  EXPECT_EQ(bench.cache.statistics().pushed, 1u);
}

}  // namespace
}  // namespace carousel::ringbus::cycle
