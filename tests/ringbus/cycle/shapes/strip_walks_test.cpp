// Strips whose end is a flag (`memory.strip_end: flag`): a cache with a list of arrivals for memory, cycle by cycle;
// what is known of their length in a shape buffer; and the bytes of a structure's strips.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/load/load.h"
#include "ringbus/cycle/shapes/shape_buffer.h"
#include "ringbus/cycle/shapes/shape_cache.h"
#include "tests/ringbus/support/timed_machine.h"
#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus::cycle {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using LinesInTime = std::vector<std::pair<Cycle, std::uint64_t>>;

MemoryConfig flagged_memory(const std::string& more) {
  return load_config({"scene: {builtin: cornell}\nengine: {kind: cycle}\nmemory: {strip_end: flag, l2_lines_per_cycle: "
                      "1, l2_latency_cycles: 2, dram_latency_cycles: 2, " +
                          more + "}\n",
                      "strips.yaml"})
      .config.memory;
}

/// A line of 64 bytes is looked up each cycle; the ways to the cache and to memory take a cycle, a line from memory
/// ten.
struct WalkBench {
  explicit WalkBench(const std::string& more) : config(flagged_memory(more)) {}

  void ask(Cycle at, std::uint64_t line, std::uint32_t lines) {
    FetchRequest request{line, lines, static_cast<std::uint32_t>(line)};
    request.ends_by_flag = true;
    requests.send(at, request);
  }
  /// Up to `end`: answers by first line, and requests to memory, with the cycle in which each left.
  void run(Cycle end) {
    for (Cycle now = 0; now < end; ++now) {
      cache.run(now + 1);
      while (down.next() != kNever) {
        const Cycle at = down.next() - 1;
        asked.emplace_back(at, down.take());
        up.send(at + 10, asked.back().second);
      }
    }
    while (answers.next() != kNever) {
      const Cycle at = answers.next() - 1;
      answered.emplace_back(at, answers.take().tag);
    }
  }

  MemoryConfig config;
  LooseChannel<FetchRequest> requests;
  LooseChannel<FetchAnswer> answers;
  LooseChannel<std::uint64_t> down, up;
  ShapeCache cache{config, {{&requests, &answers}}, down, up};
  LinesInTime answered, asked;
};

LinesInTime::value_type when(Cycle cycle, std::uint64_t line) {
  return {cycle, line};
}

TEST(StripEnds, EachLineWaitsForTheFlagsOfTheOneBefore) {
  WalkBench bench("strip_ahead: 0");
  bench.ask(100, 4, 3);   // comes in 111, 122 and 133
  bench.ask(1000, 4, 3);  // is there: a line a cycle
  bench.run(2000);
  EXPECT_THAT(bench.asked, ElementsAre(when(101, 4), when(112, 5), when(123, 6)));
  EXPECT_THAT(bench.answered, ElementsAre(when(133, 4), when(1003, 4)));
  EXPECT_EQ(bench.cache.statistics().past_end, 0u);
  EXPECT_EQ(bench.cache.statistics().lines, 6u);
}

TEST(StripEnds, LinesAheadAreFetchedAtOnceAndSomeInVain) {
  WalkBench bench("strip_ahead: 2");
  bench.ask(100, 4, 2);
  bench.run(2000);
  // Lines 4 to 6 at once; with the flags of line 4, in 111, line 7; those of line 5, in 112, are the end.
  EXPECT_THAT(bench.asked, ElementsAre(when(101, 4), when(102, 5), when(103, 6), when(112, 7)));
  EXPECT_THAT(bench.answered, ElementsAre(when(112, 4)));
  const CacheCounts& counts = bench.cache.statistics();
  EXPECT_EQ(counts.past_end, 2u);
  EXPECT_EQ(counts.past_end_misses, 2u);
  EXPECT_EQ(counts.lines, 4u);
  EXPECT_EQ(counts.lines, counts.hits + counts.merged + counts.misses);
}

TEST(StripEnds, LinesThatAreThereLetTheNextBeLookedUp) {
  WalkBench bench("strip_ahead: 1");
  bench.ask(100, 5, 1);  // and line 6
  bench.ask(1000, 4, 4);
  bench.run(2000);
  // 4 and 5 in 1000, looked up by 1001 and 1002. Line 5 is there and has to wait for line 4, which comes in 1011: then
  // 6 and 7 at once, of which 6 is there in 1012 (so that line 8 is looked up) and 7 comes in 1023.
  EXPECT_THAT(bench.asked, ElementsAre(when(101, 5), when(102, 6), when(1001, 4), when(1013, 7), when(1014, 8)));
  EXPECT_THAT(bench.answered, ElementsAre(when(111, 5), when(1023, 4)));
  EXPECT_EQ(bench.cache.statistics().past_end, 2u);
}

TEST(StripEnds, ALineBehindTheEndMayStopItsBankToo) {
  WalkBench bench("strip_ahead: 1, l2_mshrs: 1");
  bench.ask(100, 4, 1);
  bench.ask(102, 9, 1);
  bench.run(2000);
  // Line 5 waits for line 4, and line 9 for line 5, though nobody wants that.
  EXPECT_THAT(bench.asked, ElementsAre(when(101, 4), when(112, 5), when(123, 9), when(134, 10)));
  EXPECT_THAT(bench.answered, ElementsAre(when(111, 4), when(133, 9)));
}

TEST(StripEnds, ARequestNamesAStrideInsteadOfALength) {
  FetchRequest request{4, 2, 7};
  EXPECT_EQ(request.bytes(), 16u);
  request.ends_by_flag = true;
  EXPECT_EQ(request.bytes(), 14u);
}

/// A shape buffer of 1 KiB: 16 places.
TEST(StripEnds, ABufferKeepsRoomForTheLongestStripUntilTheEndIsThere) {
  const MemoryConfig config = flagged_memory("shape_buffer_kib: 1");
  LooseChannel<FetchRequest> requests;
  LooseChannel<FetchAnswer> answers;
  SidePorts side;
  side.fetch = &requests;
  side.fetched = &answers;
  ShapeBuffer buffer(config, LinkConfig{}, side);
  const auto strip = [](std::uint64_t address, std::uint32_t most) {
    return ShapeNeed{ShapeSpan{address, 64, most}, {}};
  };
  EXPECT_FALSE(buffer.take(0, strip(0, 640), 0));     // ten places
  EXPECT_FALSE(buffer.take(1, strip(4096, 640), 0));  // ten more are not free
  EXPECT_EQ(buffer.counts().room_waits, 1u);
  EXPECT_EQ(buffer.counts().misses, 1u);
  requests.take();
  answers.send(50, {0});
  buffer.take_answers(50);  // nine of the ten are free again
  EXPECT_EQ(buffer.counts().misses, 2u);
  EXPECT_FALSE(buffer.take(2, strip(8192, 320), 51));  // five, of the five that are left
  EXPECT_EQ(buffer.counts().misses, 3u);
  EXPECT_EQ(buffer.counts().room_waits, 1u);
}

TEST(StripEnds, NodesEndBehindTheirLastChildAndLeavesBehindTheirLastTriangle) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 500, 0), 16, 1);
  BvhConfig bvh;
  bvh.leaf_triangles = 3;
  const accel::Accel& accel = scene.accel(bvh, {}, {});
  const MemoryConfig config = flagged_memory("strip_ahead: 0");
  const ShapeMemory whole(accel, {}, bvh), ends(accel, {}, bvh, config);
  std::uint32_t longest_node = 0, longest_leaf = 0, shorter = 0;
  std::vector<accel::NodeKey> leaves;
  const auto leaf = [&](accel::NodeKey key) {
    const ShapeSpan span = ends.strip(key);
    EXPECT_EQ(span, (ShapeSpan{whole.strip(key).address, key.ref.triangles() * 40}));
    longest_leaf = std::max(longest_leaf, span.bytes);
    leaves.push_back(key);
    shorter += span.bytes < whole.strip(key).bytes;
  };
  for (std::uint32_t n = 0; n < accel.nodes.size(); ++n) {
    const accel::NodeKey key{kNoInstance, accel::NodeRef::inner(n)};
    EXPECT_EQ(ends.strip(key), (ShapeSpan{whole.strip(key).address, 32u * accel.nodes[n].count}));
    EXPECT_EQ(whole.strip(key).bytes, 256u);
    longest_node = std::max(longest_node, ends.strip(key).bytes);
    for (int lane = 0; lane < accel.nodes[n].count; ++lane)
      if (const accel::NodeRef child = accel.nodes[n].child[lane]; !child.is_inner() && !child.is_instance())
        leaf({kNoInstance, child});
  }
  EXPECT_GT(shorter, 0u);
  for (const accel::NodeKey key : leaves) EXPECT_EQ(ends.strip(key).most, longest_leaf);
  EXPECT_EQ(ends.strip(accel.root_key()).most, longest_node);
  EXPECT_EQ(whole.strip(accel.root_key()).most, 0u);
}

// The machine: fewer bytes are asked for; and with lines ahead time comes back, for bytes in vain.
TEST(StripEnds, SaveBytesAndCostTimeInAMachine) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 400, 1);
  const std::string text =
      "topology: {resources: 4}\nrays: {slots_per_resource: 64}\npackets: {rays: 8}\ncollections: {ready: 8}\n"
      "shading: {workers: 8, cycles_per_shade: 1}\n"
      "memory: {fetch: resource, l2_kib: 2, l2_latency_cycles: 2, dram_bytes_per_cycle: 512, shape_buffer_kib: 2}\n";
  const auto lines = [](const Outcome& outcome) {
    std::uint64_t sum = 0, in_vain = 0;
    for (const CacheCounts& cache : outcome.result.cycle->caches) {
      sum += cache.lines;
      in_vain += cache.past_end;
    }
    return std::pair(sum - in_vain, in_vain);
  };
  const Outcome length = run_text(scene, text), flag = run_text(scene, text, {"memory.strip_end=flag"}),
                ahead = run_text(scene, text, {"memory.strip_end=flag", "memory.strip_ahead=3"});
  EXPECT_LT(lines(flag).first * 20, lines(length).first * 19);
  EXPECT_EQ(lines(length).second, 0u);
  EXPECT_EQ(lines(flag).second, 0u);
  EXPECT_GT(lines(ahead).second, 0u);
  EXPECT_GT(flag.result.cycle->cycles, length.result.cycle->cycles);
  EXPECT_LT(ahead.result.cycle->cycles, flag.result.cycle->cycles);
}

}  // namespace
}  // namespace carousel::ringbus::cycle
