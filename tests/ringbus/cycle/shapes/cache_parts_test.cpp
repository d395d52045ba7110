// Banks, bounded misses, sectors and write-back of the L2 by themselves: the test plays the resource and the memory,
// and counts the cycles of each part.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/load/load.h"
#include "ringbus/cycle/memory/memory_agent.h"
#include "ringbus/cycle/shapes/shape_cache.h"
#include "ringbus/results/memory_request.h"
#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus::cycle {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Events = std::vector<std::pair<Cycle, std::uint64_t>>;

/// A cache whose requests come in the cycle in which they are made and whose memory is a list of arrivals. A line of
/// 64 bytes is looked up each cycle; the ways to the cache and to memory take a cycle.
struct Bench {
  explicit Bench(const std::string& more)
      : config(load_config({"scene: {builtin: cornell}\nengine: {kind: cycle}\nmemory: {l2_lines_per_cycle: 1, "
                            "l2_latency_cycles: 2, dram_latency_cycles: 2, " +
                                more + "}\n",
                            "cache.yaml"})
                   .config.memory) {}

  void ask(Cycle at, std::uint64_t line, std::uint32_t lines = 1) {
    requests.send(at, {line, lines, static_cast<std::uint32_t>(line)});
  }
  void write(Cycle at, std::uint64_t line, std::uint32_t bytes, std::uint32_t skipped = 0) {
    const auto lines = static_cast<std::uint32_t>(ceil_div(std::uint64_t{skipped} + bytes, fetched_bytes(config)));
    requests.send(at, {line, lines, 0, bytes, skipped});
  }
  void come(Cycle at, std::uint64_t line) { up.send(at, line); }
  /// Up to `end`: the answers by first line and the requests to memory, with the cycle in which each left.
  void run(Cycle end) {
    cache.run(end);
    for (; answers.next() != kNever;) {
      const Cycle at = answers.next() - 1;
      answered.emplace_back(at, answers.take().tag);
    }
    for (; down.next() != kNever;) {
      const Cycle at = down.next() - 1;
      asked.emplace_back(at, down.take());
    }
  }
  /// Brings lines into the cache, in this order, until cycle 1000.
  void warm(std::initializer_list<std::uint64_t> lines) {
    Cycle at = 0;
    for (const std::uint64_t line : lines) {
      ask(at, line);
      run(at + 10);
      come(at + 10, line);
      run(at += 20);
    }
    answered.clear();
    asked.clear();
    before = cache.statistics();
  }
  CacheCounts counts() const {
    CacheCounts out = cache.statistics();
    for (const auto& counter : CacheCounts::counters()) out.*counter.member -= before.*counter.member;
    return out;
  }

  MemoryConfig config;
  LooseChannel<FetchRequest> requests;
  LooseChannel<FetchAnswer> answers;
  LooseChannel<std::uint64_t> down, up;
  ShapeCache cache{config, {{&requests, &answers}}, down, up};
  /// The entries of a page come, each ten cycles after it was asked for; returns the cycle of the last.
  Cycle walk(Cycle asked_at, std::uint64_t page, int levels) {
    for (int level = 0; level < levels; ++level) {
      const std::uint64_t at = kPageTables + (std::uint64_t(level) << 44) + 8 * (page >> 9 * (levels - 1 - level));
      EXPECT_THAT(asked.back(), testing::Pair(asked_at, at / 64)) << level;
      come(asked_at += 10, at / 64);
      run(asked_at + 5);
    }
    return asked_at;
  }
  Events answered, asked;
  CacheCounts before;
};

std::pair<Cycle, std::uint64_t> at(Cycle cycle, std::uint64_t line) {
  return {cycle, line};
}

TEST(L2Banks, LinesOfOneBankWaitForOneAnother) {
  Bench two("l2_banks: 2");
  two.warm({0, 1, 2, 3});
  for (const std::uint64_t line : {0, 2, 1}) two.ask(1000, line);
  two.run(2000);
  EXPECT_THAT(two.answered, ElementsAre(at(1001, 0), at(1001, 1), at(1002, 2)));
  EXPECT_EQ(two.counts().port_waits, 1u);
  EXPECT_EQ(two.counts().port_busy, 3u);  // two cycles of one bank and one of the other

  Bench one("l2_banks: 1");
  one.warm({0, 1, 2, 3});
  for (const std::uint64_t line : {0, 2, 1}) one.ask(1000, line);
  one.run(2000);
  EXPECT_THAT(one.answered, ElementsAre(at(1001, 0), at(1002, 2), at(1003, 1)));
  EXPECT_EQ(one.counts().port_waits, 2u);
}

TEST(L2Banks, AMissOfAnIdleBankDoesNotWaitBehindABusyOne) {
  Bench bench("l2_banks: 2");
  for (const std::uint64_t line : {0, 2, 4, 1}) bench.ask(100, line);
  bench.run(200);
  EXPECT_THAT(bench.asked, ElementsAre(at(101, 0), at(101, 1), at(102, 2), at(103, 4)));
}

TEST(L2Banks, AnswerWhenTheLastLineOfARequestIsThere) {
  Bench bench("l2_banks: 4");
  bench.warm({0, 1, 2, 3, 4});
  bench.ask(1000, 4);
  bench.ask(1000, 0, 4);  // its first line waits a cycle for bank 0, the others do not
  bench.run(2000);
  EXPECT_THAT(bench.answered, ElementsAre(at(1001, 4), at(1002, 0)));
}

TEST(L2Mshrs, ABankStopsAtAMissThatCannotBeFetched) {
  Bench bench("l2_mshrs: 1");
  bench.warm({7});
  bench.ask(1000, 10);
  bench.ask(1000, 10);  // under way: no other miss
  bench.ask(1000, 11);  // stops
  bench.ask(1000, 7);   // is here, but behind it
  bench.run(1100);
  EXPECT_THAT(bench.asked, ElementsAre(at(1001, 10)));
  EXPECT_THAT(bench.answered, IsEmpty());
  bench.come(1300, 10);
  bench.run(1350);
  EXPECT_THAT(bench.asked, ElementsAre(at(1001, 10), at(1301, 11)));
  EXPECT_THAT(bench.answered, ElementsAre(at(1300, 10), at(1300, 10), at(1302, 7)));
  bench.come(1400, 11);
  bench.run(1500);
  EXPECT_EQ(bench.answered.back(), at(1400, 11));
  EXPECT_EQ(bench.counts().mshr_waits, 2u);
  EXPECT_EQ(bench.counts().merged, 1u);
  EXPECT_EQ(bench.counts().misses, 2u);
  EXPECT_EQ(bench.counts().hits, 1u);
}

TEST(L2Mshrs, AreThoseOfABank) {
  Bench bench("l2_mshrs: 1, l2_banks: 2");
  for (const std::uint64_t line : {0, 1, 2, 3}) bench.ask(100, line);
  bench.run(200);
  EXPECT_THAT(bench.asked, ElementsAre(at(101, 0), at(101, 1)));
  bench.come(300, 1);
  bench.run(400);
  EXPECT_EQ(bench.asked.back(), at(301, 3));
  EXPECT_EQ(bench.asked.size(), 3u);
}

TEST(L2Sectors, ComeOneByOneAndLeaveTogether) {
  // A set of one line of four sectors.
  Bench bench("line_bytes: 128, ways: 1, l2_kib: 1, l2_sector_bytes: 32");
  EXPECT_EQ(fetched_bytes(bench.config), 32u);
  bench.warm({1});
  bench.ask(1000, 0, 2);  // sector 1 is here, and 0 of the same line is not
  bench.run(1100);
  EXPECT_THAT(bench.asked, ElementsAre(at(1001, 0)));
  bench.come(1200, 0);
  bench.run(1300);
  EXPECT_THAT(bench.answered, ElementsAre(at(1200, 0)));
  EXPECT_EQ(bench.cache.lines(), (std::vector<std::uint64_t>{0, 1}));
  // The line eight lines on has the same place.
  bench.ask(1400, 32);
  bench.run(1500);
  bench.come(1500, 32);
  bench.run(1600);
  EXPECT_EQ(bench.cache.lines(), std::vector<std::uint64_t>{32});
}

TEST(L2WriteBack, WritesALineWhenItIsReplaced) {
  Bench bench("ways: 1, l2_kib: 1, l2_write: back");  // 16 lines
  bench.write(100, 3, 64);
  bench.ask(110, 3);
  bench.run(200);
  EXPECT_THAT(bench.asked, IsEmpty());
  EXPECT_THAT(bench.answered, ElementsAre(at(111, 3)));
  bench.ask(200, 19);
  bench.run(300);
  bench.come(300, 19);
  bench.run(400);
  EXPECT_THAT(bench.asked, ElementsAre(at(201, 19), at(300, kWriteLine | 3)));
  // The line that came in its place has not been written.
  bench.write(400, 35, 64);
  bench.run(500);
  EXPECT_EQ(bench.asked.size(), 2u);
  // Another whole line takes the place at its look-up.
  bench.write(500, 19, 64);
  bench.run(600);
  EXPECT_EQ(bench.asked.back(), at(501, kWriteLine | 35));
  EXPECT_EQ(bench.counts().kept, 3u);
  EXPECT_EQ(bench.counts().written_back, 2u);
  EXPECT_EQ(bench.counts().written, 0u);
  EXPECT_EQ(bench.counts().write_fetches, 0u);
}

TEST(L2WriteBack, FetchesALineOfWhichAPartIsWritten) {
  Bench bench("ways: 1, l2_kib: 1, l2_write: back");
  bench.write(100, 3, 100, 16);  // the end of line 3 and the beginning of line 4
  bench.run(200);
  EXPECT_THAT(bench.asked, ElementsAre(at(101, 3), at(102, 4)));
  bench.come(200, 3);
  bench.come(200, 4);
  bench.run(300);
  EXPECT_EQ(bench.counts().write_fetches, 2u);
  bench.write(300, 19, 64);
  bench.run(400);
  EXPECT_EQ(bench.asked.back(), at(301, kWriteLine | 3));
}

TEST(L2WriteBack, ThroughSendsEachLineOnAtOnce) {
  Bench bench("ways: 1, l2_kib: 1");
  bench.write(100, 3, 100, 16);
  bench.run(200);
  EXPECT_THAT(bench.asked, ElementsAre(at(101, kWriteLine | 3), at(102, kWriteLine | 4)));
  EXPECT_EQ(bench.counts().written, 2u);
}

TEST(L2WriteBack, WritesBackTheSectorsThatWereWritten) {
  Bench bench("line_bytes: 128, ways: 1, l2_kib: 1, l2_sector_bytes: 32, l2_write: back");
  bench.warm({0});
  bench.write(1000, 1, 64);  // sectors 1 and 2
  bench.run(1100);
  bench.ask(1100, 32);
  bench.run(1200);
  bench.come(1200, 32);
  bench.run(1300);
  EXPECT_THAT(bench.asked, ElementsAre(at(1101, 32), at(1200, kWriteLine | 1), at(1200, kWriteLine | 2)));
}

/// A cache of one resource with an L2 behind it: the test plays the resource and the memory.
TEST(OwnCache, AsksTheL2ForLines) {
  const MemoryConfig config =
      load_config({"scene: {builtin: cornell}\nengine: {kind: cycle}\nmemory: {l1_kib: 1, l1_latency_cycles: 9, "
                   "l1_lines_per_cycle: 2, l2_lines_per_cycle: 1, l2_latency_cycles: 31, dram_latency_cycles: 101}\n",
                   "cache.yaml"})
          .config.memory;
  LooseChannel<FetchRequest> requests;
  LooseChannel<FetchAnswer> answers;
  LooseChannel<std::uint64_t> down, up, to_memory, from_memory;
  ShapeCache own(ShapeCache::own_cache(config), std::vector{ShapeCache::Client{&requests, &answers}}, down, up);
  own.ask_a_cache();
  ShapeCache l2(config, std::vector{ShapeCache::OwnCache{&down, &up}}, {}, to_memory, from_memory);
  const auto ask = [&](Cycle at, std::uint64_t line, std::uint32_t lines) {
    requests.send(at + ShapeCache::request_latency(ShapeCache::nearest(config)), {line, lines, 5});
  };
  ask(0, 10, 3);
  own.run(20);
  l2.run(100);
  // Half of 9, two lines a cycle; half of 31, one line a cycle; half of 101.
  for (const Cycle at : {4 + 1 + 15 + 1 + 50, 4 + 1 + 15 + 2 + 50, 4 + 2 + 15 + 2 + 50}) {
    EXPECT_EQ(to_memory.next(), at);
    from_memory.send(200, to_memory.take());
  }
  l2.run(300);
  EXPECT_EQ(up.next(), 200u + 16);
  own.run(300);
  EXPECT_EQ(answers.next(), 200u + 16 + 5);
  EXPECT_EQ(answers.take().tag, 5u);
  // A hit takes its latency and the time of its lines, and the L2 hears nothing.
  ask(400, 10, 3);
  own.run(500);
  EXPECT_EQ(answers.next(), 400u + 9 + 2);
  EXPECT_EQ(down.next(), kNever);
  EXPECT_EQ(own.statistics().hits, 3u);
  EXPECT_EQ(l2.statistics().misses, 3u);
}

// A page has 64 lines, and 2^48 bytes have four levels of 512 pages. Lines that have waited leave one a cycle, as they
// are looked up.
TEST(L2Pages, LinesWaitForAWalkOfTheLevels) {
  Bench one("translation: {page_bytes: 4096, entries: 1}");
  one.ask(1000, 64 * 700 + 5, 3);
  one.run(1005);
  const Cycle end = one.walk(1001, 700, 4);
  EXPECT_EQ(end, 1041);
  EXPECT_THAT(std::vector(one.asked.end() - 3, one.asked.end()),
              ElementsAre(at(1041, 64 * 700 + 5), at(1042, 64 * 700 + 6), at(1043, 64 * 700 + 7)));
  EXPECT_EQ(one.counts().walk_reads, 4u);
  EXPECT_EQ(one.counts().page_waits, 3u * 40);
  one.ask(1100, 64 * 700 + 8);
  one.run(1110);
  EXPECT_THAT(one.asked.back(), at(1101, 64 * 700 + 8)) << "the page is there";
  one.ask(1200, 0);
  one.run(1210);
  one.walk(1201, 0, 4);
  one.ask(1300, 64 * 700 + 9);
  one.run(1310);
  one.walk(1301, 700, 4);
  const CacheCounts counts = one.counts();
  EXPECT_EQ(counts.walks, 3u) << "there is room for one page";
  EXPECT_EQ(counts.pages, 6u);
  EXPECT_EQ(counts.page_misses, 5u);
  EXPECT_EQ(counts.misses, 6u);
}

TEST(L2Pages, AWalkIsMadeForAPageAtATime) {
  Bench one("translation: {page_bytes: 2097152, entries: 4}");
  const std::uint64_t lines = 2097152 / 64;
  one.ask(1000, 3 * lines);
  one.ask(1000, 9 * lines);
  one.ask(1000, 9 * lines + 1);
  one.run(1005);
  EXPECT_EQ(one.walk(1001, 3, 3), 1031);
  EXPECT_EQ(one.walk(1031, 9, 3), 1061);
  EXPECT_THAT(one.asked.back(), at(1062, 9 * lines + 1));
  EXPECT_EQ(one.counts().walks, 2u);
}

// A line that is written through waits as well, and one of another page does not.
TEST(L2Pages, WritesNeedTheirPages) {
  Bench one("translation: {page_bytes: 4096, entries: 2}");
  one.write(1000, 1, 64);
  one.run(1005);
  EXPECT_EQ(one.walk(1001, 0, 4), 1041);
  EXPECT_THAT(one.asked.back(), at(1041, kWriteLine | 1));
  EXPECT_EQ(one.counts().pages, 1u);
}

}  // namespace
}  // namespace carousel::ringbus::cycle
