// The units of a simulated machine one by one, with mock neighbours: exactly the configured latencies, and queueing
// theory where a queue forms.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "ringbus/cycle/line_cache.h"
#include "ringbus/cycle/memory.h"
#include "ringbus/cycle/ports.h"
#include "ringbus/cycle/shape_cache.h"
#include "ringbus/cycle/unit_bank.h"

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

// ---- caches and memory

TEST(LineCache, LeastRecentlyUsedGoesFirst) {
  LineCache cache(2 * 64, 64, 2);   // one set of two ways
  cache.insert(1);
  cache.insert(2);
  EXPECT_TRUE(cache.touch(1));
  cache.insert(3);
  EXPECT_FALSE(cache.touch(2));
  EXPECT_TRUE(cache.touch(1));
  EXPECT_TRUE(cache.touch(3));
}

TEST(LineCache, SetsDoNotShareWays) {
  LineCache cache(4 * 64, 64, 2);   // two sets of two
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
  c.dram_bytes_per_cycle = 16;   // 4 cycles a line
  c.dram_latency_cycles = 101;
  c.l2_kib = 1;
  c.ways = 4;
  c.l2_latency_cycles = 31;
  return c;
}

TEST(Memory, TakesItsLatencyAndTheTimeToMoveALine) {
  const MemoryConfig config = memory_config();
  Channel<std::uint64_t> requests, answers;
  Memory memory(config, {{&requests, &answers}});
  // What a cache sends at time 0 arrives half of the latency later.
  const Cycle there = Memory::request_latency(config);
  for (const std::uint64_t line : {7, 8}) requests.send(there, line);
  memory.run(1000);
  EXPECT_EQ(answers.next(), 101u + 4);
  EXPECT_EQ(answers.take(), 7u);
  EXPECT_EQ(answers.next(), 101u + 8);
  EXPECT_EQ(answers.take(), 8u);
  EXPECT_EQ(memory.busy(), 8u);
  EXPECT_EQ(memory.next(), kNever);
}

/// A cache with a client and a memory that are played by the test.
struct CacheBench {
  MemoryConfig config = memory_config();
  Channel<FetchRequest> requests;
  Channel<FetchAnswer> answers;
  Channel<std::uint64_t> down, up;
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
  bench.ask(0, {11, 1, 2});   // line 11 is on its way
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

Token packet(std::uint32_t id, std::uint16_t cycles) { return {PacketId(id), 0, cycles, 1}; }

TEST(Ports, TailArrivesAfterLatencyAndWidths) {
  Wire wire;
  OutPort out(wire, 4, 2, 8);
  const InPort in{&wire, 4};
  out.push(packet(1, 3), 10, false);
  EXPECT_EQ(out.next(false), 10u);
  EXPECT_FALSE(out.send(9));
  EXPECT_TRUE(out.send(10));
  EXPECT_EQ(in.next(), 10u + 4 + 2);
}

TEST(Ports, CutThroughShowsTheHead) {
  Wire wire;
  OutPort out(wire, 4, 2, 8);
  out.push(packet(1, 3), 10, true);
  EXPECT_TRUE(out.send(10));
  EXPECT_EQ(wire.packets.next(), 14u);
}

TEST(Ports, APacketOccupiesTheLink) {
  Wire wire;
  OutPort out(wire, 4, 8, 8);
  for (std::uint32_t id : {1, 2}) out.push(packet(id, 3), 0, false);
  EXPECT_TRUE(out.send(0));
  EXPECT_FALSE(out.send(2));
  EXPECT_EQ(out.next(false), 3u);
  EXPECT_TRUE(out.send(3));
  EXPECT_EQ(out.busy(), 6u);
}

TEST(Ports, ACreditNeedsTheLinksLatencyToGetBack) {
  Wire wire;
  OutPort out(wire, 4, 1, 8);
  InPort in{&wire, 4};
  for (std::uint32_t id : {1, 2}) out.push(packet(id, 1), 0, false);
  EXPECT_TRUE(out.send(0));
  EXPECT_EQ(in.next(), 4u);
  EXPECT_FALSE(out.send(1));
  EXPECT_TRUE(out.blocked());
  in.take(6);   // held for two cycles
  EXPECT_EQ(out.next(false), 10u);
  out.take_credits(9);
  EXPECT_FALSE(out.send(9));
  out.take_credits(10);
  EXPECT_TRUE(out.send(10));
  EXPECT_EQ(out.stalled(), 9u);
  EXPECT_FALSE(out.blocked());
}

TEST(Ports, OpenLeavesTheReceiverPlaces) {
  Wire wire;
  OutPort out(wire, 4, 2, 1);
  EXPECT_TRUE(out.open(0, 2));
  out.launch(packet(1, 2), 0, false);
  EXPECT_FALSE(out.open(1, 1));   // the link is busy
  EXPECT_EQ(out.opens(1), 2u);
  EXPECT_TRUE(out.open(2, 1));
  EXPECT_FALSE(out.open(2, 2));   // one place left
  EXPECT_EQ(out.opens(2), kNever);
}

// ---- queueing theory

/// Mean and half width of its 99.9 % confidence interval, from the means of 32 batches.
struct Estimate {
  double mean = 0, half_width = 0;
};
class BatchMeans {
 public:
  explicit BatchMeans(std::size_t samples) : batch_((samples + kBatches - 1) / kBatches), sums_(kBatches) {}
  void add(double x) { sums_[count_++ / batch_] += x; }
  Estimate estimate() const {
    Estimate out;
    for (const double sum : sums_) out.mean += sum / static_cast<double>(batch_ * kBatches);
    double squares = 0;
    for (const double sum : sums_) squares += std::pow(sum / static_cast<double>(batch_) - out.mean, 2);
    constexpr double kStudent = 3.633;   // 31 degrees of freedom, two-sided 0.1 %
    out.half_width = kStudent * std::sqrt(squares / (kBatches - 1) / kBatches);
    return out;
  }

 private:
  static constexpr std::size_t kBatches = 32;
  std::size_t batch_, count_ = 0;
  std::vector<double> sums_;
};

constexpr std::size_t kCustomers = 640000;
constexpr Cycle kService = 1000;   // cycles, so that arrivals on whole cycles are nearly as in continuous time

/// Arrivals of a Poisson process that keeps a server with kService busy for `load` of the time.
class PoissonArrivals {
 public:
  explicit PoissonArrivals(double load) : gap_(load / static_cast<double>(kService)) {}
  Cycle next() { return static_cast<Cycle>(at_ += gap_(random_)); }

 private:
  std::mt19937_64 random_{42};
  std::exponential_distribution<double> gap_;
  double at_ = 0;
};

/// Mean wait of an M/D/1 queue in cycles (Pollaczek and Khinchine).
double wait_m_d_1(double load) { return load / (2 * (1 - load)) * static_cast<double>(kService); }

TEST(QueueingTheory, AUnitBankIsAnMD1Queue) {
  for (const double load : {0.2, 0.5, 0.8}) {
    UnitBank bank(TesterUnits{1, static_cast<std::int64_t>(kService), 1});
    PoissonArrivals arrivals(load);
    BatchMeans waits(kCustomers);
    for (std::size_t i = 0; i < kCustomers; ++i) {
      const Cycle at = arrivals.next();
      waits.add(static_cast<double>(bank.reserve(at, 1).first - 1 - at));
    }
    const Estimate wait = waits.estimate();
    EXPECT_LT(wait.half_width, 0.1 * wait.mean);
    EXPECT_NEAR(wait.mean, wait_m_d_1(load), wait.half_width) << "load " << load;
  }
}

/// Sends what arrives over a link, and calls `arrived(number, at)` for each packet's tail, whose place is free at once.
template <class Arrived>
void run_link(double load, const Arrived& arrived, std::vector<Cycle>& created) {
  Wire wire;
  OutPort out(wire, 1, 4, kCustomers);
  InPort in{&wire, 1};
  PoissonArrivals arrivals(load);
  for (std::uint32_t i = 0; i < kCustomers; ++i) {
    created.push_back(arrivals.next());
    out.push(packet(i, static_cast<std::uint16_t>(kService)), created.back(), false);
  }
  while (!out.empty()) {
    const Cycle now = out.next(false);
    out.take_credits(now);
    ASSERT_TRUE(out.send(now));
    const Cycle at = in.next();
    arrived(in.take(at).packet.value, at);
  }
}

TEST(QueueingTheory, ALinkIsAnMD1Queue) {
  for (const double load : {0.3, 0.7}) {
    std::vector<Cycle> created;
    BatchMeans waits(kCustomers);
    // The tail arrives when the packet has waited, occupied the link and crossed it.
    run_link(load, [&](std::uint32_t i, Cycle at) { waits.add(static_cast<double>(at - created[i] - kService)); }, created);
    const Estimate wait = waits.estimate();
    EXPECT_LT(wait.half_width, 0.1 * wait.mean);
    EXPECT_NEAR(wait.mean, wait_m_d_1(load), wait.half_width) << "load " << load;
  }
}

TEST(QueueingTheory, InATandemOfEqualServersTheSecondOneHasNoQueue) {
  std::vector<Cycle> created;
  UnitBank second(TesterUnits{1, static_cast<std::int64_t>(kService), 1});
  Cycle last = 0;
  run_link(0.9, [&](std::uint32_t, Cycle at) {
    EXPECT_GE(at, last + kService);   // the first lets out one a service time at most
    last = at;
    EXPECT_EQ(second.reserve(at, 1).first, at + 1);
  }, created);
}

}  // namespace
}  // namespace carousel::ringbus::cycle
