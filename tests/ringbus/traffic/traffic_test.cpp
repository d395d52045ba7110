// Synthetic traffic: conservation, invariance to threads, the sources' statistics, and a network that gets stuck.
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/config/load/load.h"
#include "core/system/error.h"
#include "core/types/enum_names.h"
#include "ringbus/cycle/traffic/traffic_engine.h"
#include "ringbus/cycle/traffic/traffic_plan.h"
#include "tests/ringbus/support/test_machine.h"
#include "tests/ringbus/traffic/traffic_config.h"

namespace carousel::ringbus {
namespace {

using Pattern = TrafficConfig::Pattern;
using Shape = TopologyShape;

/// Any network there is, with any load.
Config random_network(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto any = [&](auto... values) {
    const std::array all{values...};
    return all[random() % all.size()];
  };
  Config c = traffic_config(
      any(Shape::kRing, Shape::kBidirectional, Shape::kMultiRing, Shape::kPointToPoint), any(1, 2, 3, 8, 13, 16),
      any(Pattern::kUniform, Pattern::kTornado, Pattern::kNeighbour, Pattern::kHotspot, Pattern::kBursty),
      any(0.01, 0.2, 0.5, 0.8), 5000);
  c.image.seed = seed;
  c.topology.flow = any(Flow::kBubble, Flow::kCredits);
  c.topology.link.depth = any(2, 3, 16);
  c.topology.link.latency_cycles = any(1, 2, 4, 7);
  c.workload.traffic.source_queues =
      any(TrafficConfig::SourceQueues::kShared, TrafficConfig::SourceQueues::kPerDirection);
  c.workload.traffic.packet_bytes = any(1, 32, 33, 200);
  c.workload.traffic.inject_cycles = any(0, 1, 3);
  c.workload.traffic.eject_cycles = any(0, 2);
  return c;
}

std::string text(const Config& c) {
  return fmt::format("{} of {}, {} {}, flow {} depth {} latency {} bytes {}", enum_name(c.topology.shape),
                     c.topology.resources, enum_name(c.workload.traffic.pattern), c.workload.traffic.rate,
                     enum_name(c.topology.flow), c.topology.link.depth, c.topology.link.latency_cycles,
                     c.workload.traffic.packet_bytes);
}

// Others reported this kind of fault: tt-metal 33222, 54626; gem5 2654, tt-metal 54835.
TEST(Traffic, EveryPacketIsDeliveredOnceAndNoneFasterThanAlone) {
  for (std::uint32_t seed = run_seed(); seed < run_seed() + static_cast<std::uint32_t>(cell_count(150)); ++seed) {
    const Config c = random_network(seed);
    SCOPED_TRACE(fmt::format("seed {}: {}", seed, text(c)));
    const TrafficResult r = run_traffic(c, {});
    EXPECT_TRUE(r.complete);
    EXPECT_EQ(r.delivered, r.packets);
    EXPECT_EQ(r.latency.count(), r.offered);
    EXPECT_GT(r.offered, 0u);
    EXPECT_LE(r.accepted, r.delivered);
    EXPECT_GE(r.latency.mean(), r.zero_load_latency(c.workload.traffic) - 1e-9);
    for (std::size_t i = 0; i < r.links.size(); ++i) {
      EXPECT_LE(r.links[i].use.busy + r.links[i].use.stalled, r.cycles);
      EXPECT_LE(r.busy_in_window[i], std::min(r.links[i].use.busy, r.window_end - r.window_begin));
    }
  }
}

// Equal packets travel whatever the warm-up is. Before issue 45 the links' use was that of the whole run.
TEST(Traffic, UseOfLinksLeavesTheWarmUpOut) {
  Config c = traffic_config(Shape::kRing, 8, Pattern::kUniform, 0.1, 4000);
  const auto flits_with = [&](double warm_up) {
    c.workload.traffic.warmup_fraction = warm_up;
    const TrafficResult r = run_traffic(c, {});
    std::uint64_t flits = 0;
    for (const std::uint64_t busy : r.busy_in_window) flits += busy;
    // In the window of a steady network links move about what its packets need.
    const double needed = static_cast<double>(r.accepted_flit_hops);
    EXPECT_NEAR(static_cast<double>(flits), needed, 0.02 * needed + 64) << warm_up;
    return std::pair(flits, r.flit_hops);
  };
  const auto [all, moved] = flits_with(0);
  EXPECT_LE(all, moved);
  EXPECT_NEAR(static_cast<double>(all), static_cast<double>(moved), 200);  // some flits drain after the window
  for (const double part : {0.1, 0.5, 0.9}) {
    const auto [flits, whole] = flits_with(part);
    EXPECT_EQ(whole, moved) << part;
    EXPECT_NEAR(static_cast<double>(flits), (1 - part) * static_cast<double>(all), 0.1 * static_cast<double>(all))
        << part;
    EXPECT_LT(flits, all) << part;
  }
}

TEST(Traffic, IsTheSameOnAnyNumberOfThreads) {
  for (std::uint32_t seed = run_seed(); seed < run_seed() + static_cast<std::uint32_t>(cell_count(16)); ++seed) {
    Config c = random_network(seed + 500);
    c.topology.resources = 13;
    c.workload.traffic.packets = 2000;
    SCOPED_TRACE(fmt::format("seed {}: {}", seed, text(c)));
    const TrafficResult alone = run_traffic(c, {});
    for (const std::size_t threads : {2, 3, 8}) {
      const TrafficResult together = run_traffic(c, on_threads(threads));
      EXPECT_EQ(together.threads, threads);
      EXPECT_EQ(together.cycles, alone.cycles);
      EXPECT_EQ(together.accepted, alone.accepted);
      EXPECT_TRUE(together.latency == alone.latency);
      EXPECT_TRUE(together.links == alone.links);
      EXPECT_EQ(together.busy_in_window, alone.busy_in_window);
    }
  }
}

TEST(Traffic, SourceQueuesChangeTimesAndNotPackets) {
  for (const Shape shape : {Shape::kBidirectional, Shape::kMultiRing, Shape::kPointToPoint}) {
    Config c = traffic_config(shape, 8, Pattern::kUniform, 0.9, 20000);
    const TrafficResult shared = run_traffic(c, {});
    c.workload.traffic.source_queues = TrafficConfig::SourceQueues::kPerDirection;
    const TrafficResult apart = run_traffic(c, {});
    EXPECT_EQ(apart.delivered, shared.delivered);
    EXPECT_EQ(apart.offered, shared.offered);
    EXPECT_EQ(apart.routers, shared.routers);
    EXPECT_EQ(apart.link_packets, shared.link_packets);
    EXPECT_GT(apart.accepted, shared.accepted) << enum_name(shape);
    EXPECT_LT(apart.latency.mean(), shared.latency.mean()) << enum_name(shape);
  }
}

// All packets leave by the one way out.
TEST(Traffic, AQueueADirectionChangesNothingWithOneDirection) {
  Config c = traffic_config(Shape::kRing, 8, Pattern::kTornado, 0.9, 20000);
  const TrafficResult shared = run_traffic(c, {});
  c.workload.traffic.source_queues = TrafficConfig::SourceQueues::kPerDirection;
  const TrafficResult apart = run_traffic(c, {});
  EXPECT_EQ(apart.cycles, shared.cycles);
  EXPECT_TRUE(apart.latency == shared.latency);
}

TEST(Traffic, StopsWhenToldTo) {
  std::stop_source stop;
  stop.request_stop();
  RunOptions options;
  options.stop = stop.get_token();
  const TrafficResult r = run_traffic(traffic_config(Shape::kRing, 8, Pattern::kUniform, 0.1, 100000), options);
  EXPECT_FALSE(r.complete);
  EXPECT_LT(r.delivered, r.packets);
}

TEST(Traffic, UnprotectedRingGetsStuckAndSaysWho) {
  Config c = traffic_config(Shape::kRing, 4, Pattern::kTornado, 1.0, 10000);
  c.topology.flow = Flow::kNone;
  c.topology.link.depth = 1;
  c.topology.resources = 8;
  try {
    run_traffic(c, {});
    FAIL() << "it got through";
  } catch (const SimulationError& error) {
    EXPECT_NE(std::string(error.what()).find("resource 0; a packet of resource "), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("waits for a place"), std::string::npos) << error.what();
  }
  c.topology.flow = Flow::kCredits;
  EXPECT_EQ(run_traffic(c, {}).delivered, 10000u);
}

// ---- sources

std::uint64_t seed_of(const Config& c) {
  return static_cast<std::uint64_t>(c.image.seed);
}

cycle::TrafficPlan plan_of(const Config& c) {
  return {c.workload.traffic, seed_of(c), static_cast<std::size_t>(c.topology.resources),
          cycle::traffic_ends(c.topology, c.workload.traffic)};
}

cycle::TrafficSource source_of(const Config& c, const cycle::TrafficEnds& ends, ResourceId id,
                               const cycle::GeometricGap& gap) {
  return {c.workload.traffic, seed_of(c), static_cast<std::size_t>(c.topology.resources), ends, id, gap};
}

TEST(TrafficPlan, SharesOutExactlyThePackets) {
  for (const std::int64_t packets : {1, 7, 1000, 12345}) {
    const Config c = traffic_config(Shape::kRing, 8, Pattern::kUniform, 0.03, packets);
    const cycle::TrafficPlan plan = plan_of(c);
    std::uint64_t sum = 0;
    for (const std::uint64_t one : plan.packets) sum += one;
    EXPECT_EQ(sum, static_cast<std::uint64_t>(packets));
  }
}

// The window ended at cycle 0, and with it the load was 0, when the sources made the last packets all at once.
TEST(TrafficPlan, FullLoadIsMeasured) {
  for (const std::int64_t packets : {8, 800, 801, 8000}) {
    Config c = load_config({fmt::format("engine: {{kind: cycle}}\ntopology: {{shape: bidirectional}}\nworkload: "
                                        "{{traffic: {{rate: 1.0, packets: {}}}}}\n",
                                        packets),
                            "full.yaml"})
                   .config;
    const cycle::TrafficPlan plan = plan_of(c);
    EXPECT_EQ(plan.window.end, static_cast<std::uint64_t>((packets + 7) / 8 + 1));
    const TrafficResult r = run_traffic(c, {});
    const double cycles = static_cast<double>(r.window_end - r.window_begin);
    EXPECT_NEAR(static_cast<double>(r.offered) / (8 * cycles), 1, 2 / cycles) << packets;
    if (packets >= 800) {
      EXPECT_GT(r.accepted, 0u);
    }
  }
}

// Others reported this kind of fault: gem5 2654, tt-metal 54835.
TEST(TrafficPlan, SourcesHaveTheRateTheyAreAskedFor) {
  for (const Pattern pattern : {Pattern::kUniform, Pattern::kBursty}) {
    for (const double rate : {0.0003, 0.01, 0.1, 0.5, 0.88}) {
      const Config c = traffic_config(Shape::kRing, 8, pattern, rate, 80000);
      const cycle::TrafficPlan plan = plan_of(c);
      const double found = 80000 / (8 * static_cast<double>(plan.window.end));
      // 80,000 Bernoulli successes; a burst counts as one. Five standard errors.
      const double independent = pattern == Pattern::kBursty ? 80000.0 / (2 * 8) : 80000;
      EXPECT_NEAR(found / rate, 1, 5 * std::sqrt((1 - rate) / independent)) << enum_name(pattern) << " " << rate;
    }
  }
}

TEST(GeometricGap, HasMeanVarianceAndShapeOfBernoulliTrials) {
  for (const double rate : {1.0, 0.7, 0.1, 0.003}) {
    const cycle::GeometricGap gap(rate);
    double sum = 0, squares = 0, ones = 0;
    constexpr int kDraws = 200000;
    for (std::uint32_t i = 0; i < kDraws; ++i) {
      const PhiloxCounter words = random_block({5, i, 0, 0}, 0);
      const double g = static_cast<double>(gap(std::uint64_t{words[0]} << 32 | words[1]));
      ASSERT_GE(g, 1);
      sum += g;
      squares += g * g;
      ones += g == 1;
    }
    const double mean = sum / kDraws, variance = squares / kDraws - mean * mean, expected = (1 - rate) / (rate * rate);
    EXPECT_NEAR(mean, 1 / rate, 5 * std::sqrt(expected / kDraws) + 1e-12);
    EXPECT_NEAR(variance, expected, 0.05 * expected + 1e-12);  // its own standard error is 0.7 % at most
    EXPECT_NEAR(ones / kDraws, rate, 5 * std::sqrt(rate * (1 - rate) / kDraws) + 1e-12);
  }
}

TEST(GeometricGap, ReachesTheEndsOfTheRange) {
  const cycle::GeometricGap gap(0.1);
  EXPECT_EQ(gap(~std::uint64_t{0}), 1u);
  // (1 - 0.1)^g >= 2^-53 up to g = 348.
  EXPECT_EQ(gap(0), 349u);
}

TEST(TrafficSource, HotspotGetsItsShare) {
  Config c = traffic_config(Shape::kRing, 8, Pattern::kHotspot, 0.1, 1);
  c.workload.traffic.hotspot = 5;
  c.workload.traffic.hotspot_fraction = 0.25;
  const cycle::GeometricGap gap = cycle::traffic_gap(c.workload.traffic);
  const cycle::TrafficEnds ends = cycle::traffic_ends(c.topology, c.workload.traffic);
  cycle::TrafficSource source = source_of(c, ends, ResourceId(2), gap);
  std::array<int, 8> to{};
  for (int i = 0; i < 80000; ++i) {
    source.advance();
    ++to[source.destination().value];
  }
  for (std::size_t r = 0; r < to.size(); ++r) EXPECT_NEAR(to[r], 80000 * (0.75 / 8 + (r == 5 ? 0.25 : 0)), 500);
}

TEST(TrafficSource, BurstsAreAsLongAsAskedFor) {
  Config c = traffic_config(Shape::kRing, 8, Pattern::kBursty, 0.2, 1);
  c.workload.traffic.burst_packets = 20;
  const cycle::GeometricGap gap = cycle::traffic_gap(c.workload.traffic);
  const cycle::TrafficEnds ends = cycle::traffic_ends(c.topology, c.workload.traffic);
  cycle::TrafficSource source = source_of(c, ends, ResourceId(0), gap);
  int bursts = 0;
  for (int i = 0; i < 100000; ++i) {
    const Cycle before = source.created();
    source.advance();
    ASSERT_GT(source.created(), before);
    bursts += source.created() > before + 1;
  }
  EXPECT_NEAR(100000.0 / bursts, 20, 1.5);
}

TEST(LatencyHistogram, KeepsQuantilesWithinAThousandth) {
  LatencyHistogram h, half;
  for (Cycle latency = 1; latency <= 100000; ++latency) (latency % 2 ? h : half).add(latency);
  h.add(half);
  EXPECT_EQ(h.count(), 100000u);
  EXPECT_EQ(h.mean(), 50000.5);
  EXPECT_EQ(h.max(), 100000u);
  EXPECT_EQ(h.quantile(0.01), 1000u);
  EXPECT_NEAR(static_cast<double>(h.quantile(0.5)), 50000, 50);
  EXPECT_NEAR(static_cast<double>(h.quantile(0.99)), 99000, 99);
}

}  // namespace
}  // namespace carousel::ringbus
