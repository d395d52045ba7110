// The widths of the memory system, against closed forms: DRAM's bytes a cycle, the lines a cycle of the L2, and sizes
// that are no powers of two.
#include <gtest/gtest.h>

#include "ringbus/cycle/memory/memory.h"
#include "ringbus/cycle/shapes/cache/line_cache.h"
#include "ringbus/cycle/shapes/shape_cache.h"
#include "tests/ringbus/support/timed_machine.h"
#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus::cycle {
namespace {

MemoryConfig memory_config(const std::string& memory) {
  return load_config({"scene: {builtin: cornell}\nmemory: " + memory + "\n", "machine.yaml"}).config.memory;
}

TEST(DramBandwidth, CompletesLinesByTheByte) {
  for (const std::uint64_t width : {1, 3, 16, 24, 32, 64, 100, 128, 512}) {
    const MemoryConfig config =
        memory_config(fmt::format("{{line_bytes: 64, dram_bytes_per_cycle: {}, dram_latency_cycles: 101}}", width));
    LooseChannel<std::uint64_t> requests, answers;
    Memory memory(config, {{&requests, &answers}});
    for (std::uint64_t line = 0; line < 50; ++line) requests.send(Memory::request_latency(config), line);
    memory.run(100'000);
    for (std::uint64_t line = 0; line < 50; ++line) {
      EXPECT_EQ(answers.next(), 101 + ceil_div((line + 1) * 64, width)) << width;
      EXPECT_EQ(answers.take(), line);
    }
    EXPECT_EQ(memory.counts().busy, ceil_div(50 * 64, width));
    EXPECT_EQ(memory.counts().lines, 50u);
  }
}

TEST(DramBandwidth, ALaterRequestBeginsWithItsCycle) {
  const MemoryConfig config = memory_config("{line_bytes: 64, dram_bytes_per_cycle: 256, dram_latency_cycles: 2}");
  LooseChannel<std::uint64_t> requests, answers;
  Memory memory(config, {{&requests, &answers}});
  for (std::uint64_t line = 0; line < 5; ++line) requests.send(10, line);  // four in cycle 10, one in cycle 11
  for (std::uint64_t line = 5; line < 9; ++line) requests.send(11, line);  // three beside it, one in cycle 12
  requests.send(20, 9);
  memory.run(1000);
  for (const Cycle end : {11, 11, 11, 11, 12, 12, 12, 12, 13, 21}) {
    EXPECT_EQ(answers.next(), end + Memory::answer_latency(config));
    answers.take();
  }
}

constexpr const char* kStarved =
    "topology: {resources: 8}\nrays: {slots_per_resource: 64}\npackets: {rays: 8}\ncollections: {ready: 8}\n"
    "testers: {contexts: 8}\nshading: {workers: 8, cycles_per_shade: 1}\n"
    "memory: {fetch: resource, l2_kib: 1, shared_by: 1, l2_latency_cycles: 2, dram_latency_cycles: 2, "
    "shape_buffer_kib: 1}\n";

TEST(DramBandwidth, WiderThanALineGains) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 400, 1);
  std::uint64_t narrower = ~std::uint64_t{0};
  for (const std::string width : {"16", "32", "64", "128", "256"}) {
    const std::uint64_t cycles = cycles_of(scene, kStarved, {"memory.dram_bytes_per_cycle=" + width});
    EXPECT_LT(cycles, narrower) << width;
    narrower = cycles;
  }
}

/// Sends requests of a line each, all at once, and plays a memory that answers at once.
Cycle last_answer(const MemoryConfig& config, std::uint64_t lines, CacheCounts& counts) {
  LooseChannel<FetchRequest> requests;
  LooseChannel<FetchAnswer> answers;
  LooseChannel<std::uint64_t> down, up;
  ShapeCache cache(config, {{&requests, &answers}}, down, up);
  for (int round = 0; round < 2; ++round) {
    const Cycle at = round * 10'000 + ShapeCache::request_latency(config);
    for (std::uint64_t line = 0; line < lines; ++line) requests.send(at, {line, 1, static_cast<std::uint32_t>(line)});
    cache.run(at + 1000);
    while (down.next() != kNever) up.send(at + 2000, down.take());
    cache.run(at + 5000);
  }
  Cycle last = 0;
  for (; answers.next() != kNever; answers.take()) last = answers.next();
  counts = cache.statistics();
  return last - 10'000;
}

TEST(L2Port, LooksUpItsLinesACycle) {
  CacheCounts counts;
  for (const std::uint64_t width : {1, 2, 3, 8}) {
    const MemoryConfig config = memory_config(fmt::format("{{l2_lines_per_cycle: {}, l2_latency_cycles: 31}}", width));
    EXPECT_EQ(last_answer(config, 100, counts), 31 + ceil_div(100, width));
    EXPECT_EQ(counts.port_busy, 2 * ceil_div(100, width));
    EXPECT_EQ(counts.hits, 100u);
    EXPECT_EQ(counts.misses, 100u);
  }
}

TEST(L2Port, IsCountedAndTwiceItsLinesGain) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 400, 1);
  const std::string shared =
      "topology: {resources: 16}\nrays: {slots_per_resource: 64}\npackets: {rays: 8}\ncollections: {ready: 8}\n"
      "testers: {contexts: 8}\nshading: {workers: 8, cycles_per_shade: 1}\n"
      "memory: {fetch: resource, shared_by: 16, l2_kib: 1024, l2_latency_cycles: 2, l2_lines_per_cycle: 1, "
      "dram_bytes_per_cycle: 512, shape_buffer_kib: 1}\n";
  const Outcome one = run_text(scene, shared), two = run_text(scene, shared, {"memory.l2_lines_per_cycle=2"});
  const std::vector<CacheCounts>& caches = one.result.cycle->caches;
  ASSERT_EQ(caches.size(), 1u);
  EXPECT_EQ(caches[0].port_busy, caches[0].lines);
  EXPECT_GT(2 * caches[0].port_busy, one.result.cycle->cycles);  // it limits this machine
  EXPECT_LT(two.result.cycle->cycles * 10, one.result.cycle->cycles * 9);
}

// ---- sizes

TEST(CacheSize, SetsNeedNoPowerOfTwo) {
  LineCache cache(6 * 64, 64, 2);  // three sets of two
  for (const std::uint64_t line : {0, 3, 1, 4, 2, 5}) cache.insert(line);
  for (const std::uint64_t line : {0, 1, 2, 3, 4, 5}) EXPECT_TRUE(cache.touch(line)) << line;
  cache.insert(6);
  EXPECT_FALSE(cache.touch(0));
  EXPECT_TRUE(cache.touch(3));
}

TEST(CacheSize, EveryKibibyteOfTheL2Counts) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 400, 1);
  const auto misses = [&](const std::string& kib) {
    const Outcome outcome = run_text(scene, kStarved, {"memory.l2_kib=" + kib});
    std::uint64_t sum = 0;
    for (const CacheCounts& cache : outcome.result.cycle->caches) sum += cache.misses;
    return sum;
  };
  const std::uint64_t four = misses("4"), six = misses("6"), seven = misses("7");
  EXPECT_LT(six, four);
  EXPECT_LT(seven, six);
}

}  // namespace
}  // namespace carousel::ringbus::cycle
