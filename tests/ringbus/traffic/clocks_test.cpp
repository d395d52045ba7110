// The clock of a drawn network against that of its resources.
#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/config/load/load.h"
#include "ringbus/cycle/traffic/traffic_engine.h"
#include "ringbus/time/clock_ratio.h"

namespace carousel::ringbus::clocks_test {
namespace {

TEST(ClockRatio, EdgesAreExactAfterAnyTime) {
  const ClockRatio ratio(1500, 2000, 2);
  EXPECT_EQ(ratio.to_network(3), 4u);
  EXPECT_EQ(ratio.to_network(4), 6u);  // at 5 1/3
  EXPECT_EQ(ratio.to_core(4), 3u);
  EXPECT_EQ(ratio.to_core(5), 4u);  // at 3 3/4
  EXPECT_EQ(ratio.enter(3), 6u);
  EXPECT_EQ(ratio.leave(4), 5u);
  constexpr Cycle kLong = 3'000'000'000'000;  // half an hour; a float of 64 bits would have drifted at 1/3
  EXPECT_EQ(ratio.to_network(kLong + 1), kLong / 3 * 4 + 2);
  const ClockRatio odd(99'991, 100'000, 0);
  EXPECT_EQ(odd.to_network(99'991 * Cycle{1'000'000'000}), 100'000 * Cycle{1'000'000'000});
  EXPECT_EQ(odd.to_network(99'991 * Cycle{1'000'000'000} + 1), 100'000 * Cycle{1'000'000'000} + 2);
  EXPECT_EQ(ClockRatio(500, 500, 9).enter(7), 7u);
}

Config line(const std::string& clocks, const std::string& traffic) {
  return load_config({"engine: {kind: cycle}\n" + clocks +
                          "topology: {shape: graph, nodes: [{name: r, count: 4, latency_cycles: 1}], links: [{line: "
                          "'r[*]', both: true, latency_cycles: 4}]}\nworkload: {traffic: {" +
                          traffic + "}}\n",
                      "line.yaml"})
      .config;
}

// Packets from one end to the other, one at a time: 3 to get in, to the next edge of the network, synchronised in 2 of
// its cycles, 3 links of 5 cycles, 3 flits more, to the next edge of the resources, 2, and 3 to get out.
TEST(Clocks, APacketAloneCrossesTwice) {
  const std::string ends =
      "sources: 'r[0]', destinations: 'r[3]', packet_bytes: 128, inject_cycles: 3, eject_cycles: 3";
  const Config config = line("clocks: {core: 1500, noc: 2000}\n", ends + ", rate: 0.001, packets: 300");
  EXPECT_EQ(config.engine.clock_mhz, 1500);
  const TrafficResult result = run_traffic(config, {});
  EXPECT_EQ(result.delivered, 300u);
  // 2 + 15 + 3 = 20 cycles of the network are 15 of the resources, and two edges cost less than one and a third each.
  EXPECT_GE(result.latency.quantile(0), 3u + 15 + 2 + 3);
  EXPECT_LE(result.latency.max(), 3u + 15 + 2 + 3 + 1);
  EXPECT_NEAR(result.latency.mean(), result.zero_load_latency(config.workload.traffic), 1e-9);
  // A third of all cycles of the resources are edges of both, without a wait.
  EXPECT_NEAR(result.latency.mean(), 23 + 2.0 / 3, 0.1);
}

// The network's clock, not that of the resources, says what a link moves.
TEST(Clocks, LinksMoveAFlitForEachCycleOfTheirOwn) {
  for (const int noc : {250, 500, 750, 1000, 2000}) {
    const Config config = line(fmt::format("clocks: {{core: 1000, noc: {}}}\n", noc),
                               "sources: 'r[0]', destinations: 'r[1]', rate: 1, packets: 20000, packet_bytes: 64");
    const TrafficResult result = run_traffic(config, {});
    const double cycles = static_cast<double>(result.window_end - result.window_begin);
    EXPECT_EQ(result.delivered, 20000u);
    EXPECT_NEAR(static_cast<double>(result.accepted) / cycles, std::min(1.0, noc / 2000.0), 0.005) << noc;
  }
}

/// A clock, by its period in parts of a common time.
struct Period {
  std::uint64_t length = 1;
  /// Crosses to it from another clock at `time`, with synchronisers of two cycles.
  std::uint64_t enter(std::uint64_t time, const Period& from) const {
    if (from.length == length) return time;
    return (time + length - 1) / length * length + 2 * length;
  }
};

// The closed form of three links, each by a clock of its own, and a router between them, by arithmetic of its own: the
// time is counted in parts of which each clock's period is a whole number.
TEST(Clocks, APacketOverLinksOfSeveralClocksTakesTheClosedForm) {
  for (const std::array<int, 4>& mhz : {std::array{1500, 2000, 700, 900},
                                        {1000, 1000, 333, 1000},
                                        {800, 800, 800, 800},
                                        {700, 1400, 100, 2800},
                                        {1999, 2000, 2001, 97}}) {
    for (const int flits : {1, 3}) {
      SCOPED_TRACE(fmt::format("{} {} {} {}: {}", mhz[0], mhz[1], mhz[2], mhz[3], flits));
      const Config config =
          load_config(
              {fmt::format("engine: {{kind: cycle}}\nclocks: {{core: {}, noc: {}, far: {}, door: {}}}\n"
                           "topology:\n  shape: graph\n"
                           "  nodes: [{{name: r, count: 2, latency_cycles: 2}}, {{name: x, kind: router, "
                           "latency_cycles: 3, clock: door}}]\n"
                           "  links: [{{from: 'r[0]', to: x, both: true, latency_cycles: 4}},\n"
                           "    {{from: x, to: 'r[1]', both: true, latency_cycles: 5, clock: far}}]\n"
                           "workload: {{traffic: {{sources: 'r[0]', destinations: 'r[1]', rate: 0.3, packets: 1, "
                           "warmup_fraction: 0, packet_bytes: {}, inject_cycles: 6, eject_cycles: 7}}}}\n",
                           mhz[0], mhz[1], mhz[2], mhz[3], 32 * flits),
               "far.yaml"})
              .config;
      const TrafficResult result = run_traffic(config, {});
      ASSERT_EQ(result.delivered, 1u);
      std::uint64_t common = 1;
      for (const int one : mhz) common = std::lcm(common, static_cast<std::uint64_t>(one));
      const auto period = [&](int one) { return Period{common / static_cast<std::uint64_t>(one)}; };
      const Period core = period(mhz[0]), noc = period(mhz[1]), far = period(mhz[2]), door = period(mhz[3]);
      const std::uint64_t delivered = result.cycles - 1, created = delivered - result.latency.max();
      const std::uint64_t first = noc.enter((created + 6) * core.length, core);
      std::uint64_t tail = 0, router_free = 0, far_free = 0;
      for (int flit = 0; flit < flits; ++flit) {
        const std::uint64_t on = first + (2 + static_cast<std::uint64_t>(flit)) * noc.length;
        // The router passes a flit on in each of its cycles, but not before the link is free for it.
        std::uint64_t leaves = std::max(router_free, door.enter(on + 4 * noc.length, noc));
        while (far.enter(leaves + 3 * door.length, door) < far_free) leaves += door.length;
        router_free = leaves + door.length;
        const std::uint64_t over = far.enter(leaves + 3 * door.length, door);
        far_free = over + far.length;
        tail = noc.enter(over + 5 * far.length, far);
      }
      EXPECT_EQ(delivered, core.enter(tail, noc) / core.length + 7);
      EXPECT_EQ(core.enter(tail, noc) % core.length, 0u);
      EXPECT_NEAR(result.latency.mean(), result.zero_load_latency(config.workload.traffic), 1e-9);
    }
  }
}

// A slow link is what a flow over it gets, also where its channels take turns, and none of it is early.
TEST(Clocks, ASlowLinkBoundsWhatItsChannelsShare) {
  for (const int channels : {1, 4})
    for (const int slow : {200, 500, 900, 3000}) {
      const Config config =
          load_config(
              {fmt::format("engine: {{kind: cycle}}\nclocks: {{slow: {}}}\n"
                           "topology: {{shape: graph, link: {{virtual_channels: {}, depth: 32}}, nodes: [{{name: "
                           "r, count: 2, latency_cycles: 1}}], links: [{{line: 'r[*]', both: true, "
                           "latency_cycles: 3, clock: slow}}]}}\n"
                           "workload: {{traffic: {{sources: 'r[0]', destinations: 'r[1]', rate: 1, packets: "
                           "20000}}}}\n",
                           slow, channels),
               "slow.yaml"})
              .config;
      const TrafficResult result = run_traffic(config, {});
      const double cycles = static_cast<double>(result.window_end - result.window_begin);
      EXPECT_EQ(result.delivered, 20000u);
      EXPECT_NEAR(static_cast<double>(result.accepted) / cycles, std::min(1.0, slow / 1000.0), 0.005) << slow;
      ASSERT_EQ(result.link_windows.size(), 2u);
      EXPECT_LE(result.busy_in_window[0], result.link_windows[0]);
      EXPECT_EQ(result.links[0].use.busy, 20000u);
    }
}

TEST(Clocks, ClocksOfOneFrequencyAreOne) {
  const std::string load =
      "workload: {traffic: {rate: 0.1, packets: 5000, packet_bytes: 64}}\ntopology:\n  shape: graph\n  nodes: [{name: "
      "r, "
      "count: 4, latency_cycles: 1";
  const auto run = [&](const std::string& clocks, const std::string& node, const std::string& link) {
    return run_traffic(load_config({"engine: {kind: cycle}\n" + clocks + load + node +
                                        "}]\n  links: [{line: 'r[*]', both: true, latency_cycles: 4" + link + "}]\n",
                                    "one.yaml"})
                           .config,
                       {});
  };
  const TrafficResult one = run("", "", ""),
                      two = run("clocks: {a: 1000, b: 1000, synchroniser_cycles: 9}\n", ", clock: a", ", clock: b");
  EXPECT_EQ(one.cycles, two.cycles);
  EXPECT_EQ(one.latency, two.latency);
  EXPECT_EQ(one.busy_in_window, two.busy_in_window);
}

TEST(Clocks, EqualClocksAreOne) {
  const std::string load = "rate: 0.1, packets: 5000, packet_bytes: 64";
  const TrafficResult one = run_traffic(line("", load), {});
  const TrafficResult two = run_traffic(line("clocks: {core: 1000, noc: 1000, synchroniser_cycles: 7}\n", load), {});
  EXPECT_EQ(one.cycles, two.cycles);
  EXPECT_EQ(one.latency, two.latency);
  EXPECT_EQ(one.busy_in_window, two.busy_in_window);
}

}  // namespace
}  // namespace carousel::ringbus::clocks_test
