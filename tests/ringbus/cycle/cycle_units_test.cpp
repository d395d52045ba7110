// The units of a simulated machine one by one, with mock neighbours: exactly the configured latencies.
#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "ringbus/cycle/fabric/ports.h"
#include "ringbus/cycle/memory/memory.h"
#include "ringbus/cycle/shapes/cache/line_cache.h"
#include "ringbus/cycle/shapes/shape_cache.h"
#include "ringbus/cycle/testers/tester.h"
#include "ringbus/cycle/testers/unit_bank.h"
#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus::cycle {
namespace {

// ---- UnitBank

TEST(UnitBank, AnswersAfterItsLatency) {
  UnitBank bank(TesterUnits{1, 1, 7});
  const UnitBank::Reservation one = bank.reserve(100, 1);
  EXPECT_EQ(one.first, 107u);
  EXPECT_EQ(one.last, 107u);
  EXPECT_EQ(bank.busy(), 1u);
}

TEST(UnitBank, StartsATestInEachUnitEveryInterval) {
  UnitBank bank(TesterUnits{4, 3, 10});
  // 9 tests on 4 units: rounds at 0, 3 and 6.
  const UnitBank::Reservation nine = bank.reserve(0, 9);
  EXPECT_EQ(nine.first, 10u);
  EXPECT_EQ(nine.last, 16u);
  EXPECT_EQ(bank.busy(), 9u);
  // Busy until 9, so the next ones wait.
  EXPECT_EQ(bank.reserve(2, 1).first, 19u);
  EXPECT_EQ(bank.reserve(50, 1).first, 60u);
  EXPECT_EQ(bank.tests(), 11u);
}

TEST(UnitBank, NoTestsTakeNoTime) {
  UnitBank bank(TesterUnits{2, 5, 5});
  bank.reserve(0, 2);
  EXPECT_EQ(bank.reserve(1, 0).last, 1u);
  EXPECT_EQ(bank.busy(), 5u);
}

// ---- lanes

/// The cycle of the last answer to box tests of some rays against some boxes each, by two units with lanes.
Cycle boxes_end(TestersConfig::Simd simd, std::uint64_t rays, std::uint64_t boxes) {
  TestersConfig config;
  config.simd = simd;
  config.units[UnitKind::kBox] = {2, 3, 10};
  IntersectionCounts counts;
  counts.box = rays * boxes;
  return Tester(config).strip(100, counts, rays);
}

TEST(Lanes, EachHoldsARayAndTheShapesStreamPast) {
  using enum TestersConfig::Simd::Map;
  // 10 rays in 4 lanes are 3 vectors; against 5 boxes 15 starts, on two units 8 rounds of 3 cycles.
  EXPECT_EQ(boxes_end({4, kRays, 0}, 10, 5), 100u + 7 * 3 + 10);
  EXPECT_EQ(boxes_end({4, kRays, 6}, 10, 5), 100u + 7 * 3 + 10 + 6) << "the results are reformatted";
  EXPECT_EQ(boxes_end({64, kRays, 0}, 10, 5), 100u + 2 * 3 + 10) << "lanes stay empty";
  EXPECT_EQ(boxes_end({1, kRays, 6}, 10, 5), 100u + 24 * 3 + 10) << "one lane: each test by itself";
}

TEST(Lanes, EachHoldsAShapeAndTheRaysStreamPast) {
  using enum TestersConfig::Simd::Map;
  // 5 boxes in 4 lanes are 2 vectors; 10 rays make 20 starts, on two units 10 rounds.
  EXPECT_EQ(boxes_end({4, kShapes, 0}, 10, 5), 100u + 9 * 3 + 10);
  EXPECT_EQ(boxes_end({8, kShapes, 2}, 10, 5), 100u + 4 * 3 + 10 + 2);
  EXPECT_EQ(boxes_end({1, kShapes, 2}, 10, 5), 100u + 24 * 3 + 10);
}

TEST(Lanes, ASingleRayFillsOneLaneOrItsShapesDo) {
  TestersConfig config;
  config.units[UnitKind::kBox] = {1, 1, 10};
  IntersectionCounts counts;
  counts.box = 8;
  config.simd = {4, TestersConfig::Simd::Map::kRays, 5};
  EXPECT_EQ(Tester(config).ray(100, counts), 100u + 7 + 10);
  config.simd.map = TestersConfig::Simd::Map::kShapes;
  EXPECT_EQ(Tester(config).ray(100, counts), 100u + 1 + 10);
}

// ---- banks of ray memory

/// When the tests of three packets end that come at the same time: one, one against boxes, and one against triangles.
struct TestEnds {
  Cycle first, then_boxes, then_triangles;
  Cycle busy_reads;  ///< cycles of the ports
};

// 8 rays in 4 banks, `most` of them in one; box and triangle units for all at once, with a latency of 10.
TestEnds banked_ends(std::uint64_t boxes, std::uint64_t triangles, std::uint64_t most) {
  TestersConfig config;
  config.units[UnitKind::kBox] = config.units[UnitKind::kTriangle] = {64, 1, 10};
  Tester tester(config, CullPlanesConfig::Order::kBoxFirst, 0, 1, 4);
  const auto strip = [&](Cycle at, std::uint64_t b, std::uint64_t t) {
    IntersectionCounts counts;
    counts.box = b;
    counts.triangle = t;
    return tester.strip(at, counts, 8, {}, {0, most});
  };
  const Cycle one = strip(100, boxes, triangles);
  return {one, strip(100, 8, 0), strip(100, 0, 8), tester.reads_before(1000) + tester.primitive_reads_before(1000)};
}

TEST(RayBanks, HaveAPortToTheBoxUnitsAndOneToThoseOfPrimitives) {
  // The fullest bank reads 5 records, one a cycle; tests begin behind the last of them.
  const TestEnds boxes = banked_ends(8, 0, 5), triangles = banked_ends(0, 8, 5), both = banked_ends(8, 8, 5);
  EXPECT_EQ(boxes.first, 100u + 5 + 10);
  EXPECT_EQ(boxes.then_boxes, 100u + 10 + 10) << "behind the others of that port";
  EXPECT_EQ(boxes.then_triangles, 100u + 5 + 10) << "beside them";
  EXPECT_EQ(triangles.then_boxes, 100u + 5 + 10);
  EXPECT_EQ(triangles.then_triangles, 100u + 10 + 10);
  // A node with boxes and triangles reads each record through both ports.
  EXPECT_EQ(both.then_boxes, 100u + 10 + 10);
  EXPECT_EQ(both.then_triangles, 100u + 10 + 10);
  EXPECT_EQ(boxes.busy_reads, 15u);
  EXPECT_EQ(both.busy_reads, 20u);
}

// ---- caches and memory

TEST(LineCache, LeastRecentlyUsedGoesFirst) {
  LineCache cache(2 * 64, 64, 2);  // one set of two ways
  cache.insert(1);
  cache.insert(2);
  EXPECT_TRUE(cache.touch(1));
  cache.insert(3);
  EXPECT_FALSE(cache.touch(2));
  EXPECT_TRUE(cache.touch(1));
  EXPECT_TRUE(cache.touch(3));
}

TEST(LineCache, SetsDoNotShareWays) {
  LineCache cache(4 * 64, 64, 2);  // two sets of two
  for (const std::uint64_t line : {0, 2, 4}) cache.insert(line);
  cache.insert(1);
  EXPECT_FALSE(cache.touch(0));
  EXPECT_TRUE(cache.touch(1));
  EXPECT_TRUE(cache.touch(2));
  EXPECT_TRUE(cache.touch(4));
}

MemoryConfig memory_config() {
  MemoryConfig c;
  c.line_bytes = 64;
  c.dram_bytes_per_cycle = 16;  // 4 cycles a line
  c.dram_latency_cycles = 101;
  c.l2_kib = 1;
  c.ways = 4;
  c.l2_latency_cycles = 31;
  c.l2_lines_per_cycle = 1;
  return c;
}

TEST(Memory, TakesItsLatencyAndTheTimeToMoveALine) {
  const MemoryConfig config = memory_config();
  LooseChannel<std::uint64_t> requests, answers;
  Memory memory(config, {{&requests, &answers}});
  // A request that a cache sends at time 0 arrives half of the latency later.
  const Cycle there = Memory::request_latency(config);
  for (const std::uint64_t line : {7, 8}) requests.send(there, line);
  memory.run(1000);
  EXPECT_EQ(answers.next(), 101u + 4);
  EXPECT_EQ(answers.take(), 7u);
  EXPECT_EQ(answers.next(), 101u + 8);
  EXPECT_EQ(answers.take(), 8u);
  EXPECT_EQ(memory.counts().busy, 8u);
  EXPECT_EQ(memory.next(), kNever);
}

/// A cache with a client and a memory that are played by the test.
struct CacheBench {
  MemoryConfig config = memory_config();
  LooseChannel<FetchRequest> requests;
  LooseChannel<FetchAnswer> answers;
  LooseChannel<std::uint64_t> down, up;
  ShapeCache cache{config, {{&requests, &answers}}, down, up};

  void ask(Cycle at, FetchRequest request) { requests.send(at + ShapeCache::request_latency(config), request); }
};

TEST(ShapeCache, AHitTakesItsLatencyAndACycleForEachLine) {
  CacheBench bench;
  bench.ask(0, {10, 3, 1});
  bench.cache.run(50);
  while (bench.down.next() != kNever) bench.up.send(60, bench.down.take());
  bench.cache.run(100);
  ASSERT_NE(bench.answers.next(), kNever);
  bench.answers.take();
  bench.ask(200, {10, 3, 2});
  bench.cache.run(1000);
  EXPECT_EQ(bench.answers.next(), 200u + 31 + 3);
  EXPECT_EQ(bench.answers.take().tag, 2u);
  EXPECT_EQ(bench.cache.statistics().hits, 3u);
  EXPECT_EQ(bench.cache.statistics().misses, 3u);
}

TEST(ShapeCache, AMissWaitsForItsLastLineAndIsAskedForOnce) {
  CacheBench bench;
  bench.ask(0, {10, 2, 1});
  bench.ask(0, {11, 1, 2});  // line 11 is on its way
  bench.cache.run(50);
  const Cycle in = ShapeCache::request_latency(bench.config), out = ShapeCache::answer_latency(bench.config);
  EXPECT_EQ(bench.down.next(), in + 1 + Memory::request_latency(bench.config));
  EXPECT_EQ(bench.down.take(), 10u);
  EXPECT_EQ(bench.down.next(), in + 2 + Memory::request_latency(bench.config));
  EXPECT_EQ(bench.down.take(), 11u);
  EXPECT_EQ(bench.down.next(), kNever);
  bench.up.send(300, 11);
  bench.up.send(400, 10);
  bench.cache.run(1000);
  EXPECT_EQ(bench.answers.next(), 300 + out);
  EXPECT_EQ(bench.answers.take().tag, 2u);
  EXPECT_EQ(bench.answers.next(), 400 + out);
  EXPECT_EQ(bench.answers.take().tag, 1u);
  EXPECT_EQ(bench.cache.statistics().merged, 1u);
}

// ---- links

Token packet(std::uint32_t id, std::uint16_t cycles) {
  return {.packet = PacketId(id), .rays = 1, .link_cycles = cycles};
}

TEST(Ports, TailArrivesAfterLatencyAndWidths) {
  LooseWire wire;
  OutPort out(wire, 4, 2, 8);
  const InPort in{&wire, 4};
  out.push(packet(1, 3), 10, false);
  EXPECT_EQ(out.next(false), 10u);
  EXPECT_FALSE(out.send(9));
  EXPECT_TRUE(out.send(10));
  EXPECT_EQ(in.next(), 10u + 4 + 2);
}

TEST(Ports, CutThroughShowsTheHead) {
  LooseWire wire;
  OutPort out(wire, 4, 2, 8);
  out.push(packet(1, 3), 10, true);
  EXPECT_TRUE(out.send(10));
  EXPECT_EQ(wire.packets.next(), 14u);
}

TEST(Ports, APacketOccupiesTheLink) {
  LooseWire wire;
  OutPort out(wire, 4, 8, 8);
  for (std::uint32_t id : {1, 2}) out.push(packet(id, 3), 0, false);
  EXPECT_TRUE(out.send(0));
  EXPECT_FALSE(out.send(2));
  EXPECT_EQ(out.next(false), 3u);
  EXPECT_TRUE(out.send(3));
  EXPECT_EQ(out.busy(), 6u);
}

TEST(Ports, ACreditNeedsTheLinksLatencyToGetBack) {
  LooseWire wire;
  OutPort out(wire, 4, 1, 8);
  InPort in{&wire, 4};
  for (std::uint32_t id : {1, 2}) out.push(packet(id, 1), 0, false);
  EXPECT_TRUE(out.send(0));
  EXPECT_EQ(in.next(), 4u);
  EXPECT_FALSE(out.send(1));
  EXPECT_EQ(out.blocked_from(), 1u);
  in.take(6);  // held for two cycles
  EXPECT_EQ(out.next(false), 10u);
  out.take_credits(9);
  EXPECT_FALSE(out.send(9));
  out.take_credits(10);
  EXPECT_TRUE(out.send(10));
  EXPECT_EQ(out.stalled(), 9u);
  EXPECT_EQ(out.blocked_from(), kNever);
}

// The ledger of a link's queue against counting, cycle by cycle, what has come and not been taken.
TEST(Ports, QueueLedgerIsWhatCountingEveryCycleGives) {
  std::mt19937 random(7);
  LooseWire wire;
  OutPort out(wire, 3, 1000, 1000);
  InPort in{&wire, 3};
  std::vector<Cycle> arrivals;
  std::size_t taken = 0, sent = 0;
  Cycle counted = 0;
  std::uint64_t most = 0;
  for (Cycle now = 1; taken < 500; ++now) {
    if (sent < 500 && random() % 2 == 0) out.push(packet(static_cast<std::uint32_t>(sent++), 1), now, false);
    if (out.send(now)) arrivals.push_back(now + 3);
    // A receiver that pauses, and then takes several at once.
    if (now / 16 % 3 != 0)
      for (std::uint32_t n = random() % 3; n > 0 && in.next() <= now; --n, ++taken) in.take(now);
    const auto come = static_cast<std::uint64_t>(
        std::count_if(arrivals.begin(), arrivals.end(), [&](Cycle at) { return at <= now; }));
    counted += come - taken;  // in the queue from now to now + 1
    most = std::max(most, come - taken);
  }
  EXPECT_EQ(wire.queue.packet_cycles, counted);
  EXPECT_EQ(wire.queue.most, most);
  EXPECT_GT(most, 8u);
}

TEST(Ports, OpenLeavesTheReceiverPlaces) {
  LooseWire wire;
  OutPort out(wire, 4, 2, 1);
  EXPECT_TRUE(out.open(0, 2));
  out.launch(packet(1, 2), 0, false);
  EXPECT_FALSE(out.open(1, 1));  // the link is busy
  EXPECT_EQ(out.opens(1), 2u);
  EXPECT_TRUE(out.open(2, 1));
  EXPECT_FALSE(out.open(2, 2));  // one place left
  EXPECT_EQ(out.opens(2), kNever);
}

}  // namespace
}  // namespace carousel::ringbus::cycle
