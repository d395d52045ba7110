// Rings that exist, from configs/rings: the numbers that were published of them.
#include <gtest/gtest.h>

#include "tests/ringbus/rings/ring_run.h"

namespace carousel::ringbus::published_rings_test {
namespace {

double gigabytes_per_second(const std::vector<std::string>& sets) {
  const Config config = ring_file("cell_eib.yaml", sets);
  const TrafficResult result = run_ring(config);
  EXPECT_EQ(result.delivered, result.packets);
  return accepted_bytes(config, result) * static_cast<double>(config.engine.clock_mhz) / 1000;
}

// Twelve transfers at a time of 16 bytes, at 1.6 GHz; one command of 128 bytes for each cycle of the bus.
TEST(CellEib, AcceptsWhatItsCommandBusAdmits) {
  EXPECT_NEAR(gigabytes_per_second({}), 204.8, 0.02 * 204.8);
}

TEST(CellEib, AcceptsWhatItsRingsMoveWithoutTheCommandBus) {
  EXPECT_NEAR(gigabytes_per_second({"topology.links.0.stops.command_cycles=0"}), 307.2, 0.02 * 307.2);
}

// Three transfers on a ring at a time are what limits the rings: with two they move two thirds.
TEST(CellEib, ATransferLessOnARingIsAThirdLess) {
  EXPECT_NEAR(gigabytes_per_second({"topology.links.0.stops.command_cycles=0", "topology.links.0.stops.transfers=2"}),
              204.8, 0.02 * 204.8);
}

// A start on a ring every three cycles: 4 x 128 / 3 bytes at 1.6 GHz.
TEST(CellEib, AcceptsLessWithAStartEveryThreeCycles) {
  EXPECT_NEAR(
      gigabytes_per_second({"topology.links.0.stops.command_cycles=0", "topology.links.0.stops.start_cycles=3"}),
      273.07, 0.01 * 273.07);
}

// All to the next stop fill the rings of one direction alone.
TEST(CellEib, NeighboursInOneDirectionGetHalf) {
  EXPECT_NEAR(gigabytes_per_second({"topology.links.0.stops.command_cycles=0", "workload.traffic.pattern=neighbour"}),
              153.6, 0.02 * 153.6);
}

// 128 bytes in 8 beats: created, a cycle to get in, a cycle of the bus for the arbiter, one for the segment, seven for
// the other beats, a cycle to get out. Two cycles of the core are one of the bus.
TEST(CellEib, ATransferTakesEightBeats) {
  const Config config = ring_file("cell_eib.yaml", {"workload.traffic.rate=0.00001", "workload.traffic.packets=100"});
  const TrafficResult result = run_ring(config);
  EXPECT_EQ(result.flits, 8u);
  EXPECT_EQ(result.latency.quantile(0), 1 + 2 * (1 + 1 + 7) + 1);
  EXPECT_LE(result.latency.max(), 1 + 1 + 2 * (1 + 1 + 7) + 1);  // and up to one until the edge of the bus
}

Config bridge(const std::vector<std::string>& sets) {
  return ring_file("sandy_bridge.yaml", sets);
}

TEST(SandyBridge, SlicesAreTwentySixToThirtyOneCyclesAway) {
  const TrafficResult result = run_ring(bridge({}));
  EXPECT_EQ(result.latency.quantile(0), 26u);
  EXPECT_EQ(result.latency.max(), 31u);
  EXPECT_EQ(result.latency.max() - result.latency.quantile(0), 5u);
}

TEST(SandyBridge, EachSliceIsAsFarAsItsHops) {
  const std::uint64_t from_inner[] = {29, 26, 29, 31};
  const std::uint64_t from_outer[] = {26, 29, 31, 33};  // three hops to the other end, either way round
  for (int slice = 0; slice < 4; ++slice) {
    const std::string to = "workload.traffic.destinations=core[" + std::to_string(slice) + "]";
    for (const bool inner : {true, false}) {
      const TrafficResult result =
          run_ring(bridge({to, inner ? "workload.traffic.sources=core[1]" : "workload.traffic.sources=core[0]"}));
      const std::uint64_t expected = inner ? from_inner[slice] : from_outer[slice];
      EXPECT_EQ(result.latency.quantile(0), expected) << slice;
      EXPECT_EQ(result.latency.max(), expected) << slice;
    }
  }
}

// 32 bytes a stop and cycle, from however many rings they come, and never more.
TEST(SandyBridge, AStopTakesThirtyTwoBytesACycle) {
  const Config config =
      bridge({"workload.traffic.sources=core[0], core[2], core[3]", "workload.traffic.destinations=core[1]",
              "workload.traffic.reply_bytes=0", "workload.traffic.rate=1", "workload.traffic.packets=30000"});
  const TrafficResult result = run_ring(config);
  EXPECT_EQ(result.delivered, 30000u);
  EXPECT_LE(accepted_bytes(config, result), 32.0);
  EXPECT_GT(accepted_bytes(config, result), 0.98 * 32);
}

}  // namespace
}  // namespace carousel::ringbus::published_rings_test
