// The clock of a drawn network against that of its resources.
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
