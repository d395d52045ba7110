// The network alone against closed forms and against another simulator's numbers (docs/internals/validation.md).
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/config/load/load.h"
#include "core/types/enum_names.h"
#include "ringbus/cycle/traffic/traffic_engine.h"
#include "tests/ringbus/traffic/traffic_config.h"

namespace carousel::ringbus {
namespace {

using Pattern = TrafficConfig::Pattern;
using Shape = TopologyShape;

struct BookSimRow {
  std::string pipeline, pattern;
  std::int64_t resources = 0, flits = 0;
  double routers = 0, latency = 0;
};

std::vector<BookSimRow> booksim_rows() {
  std::ifstream file(CAROUSEL_SOURCE_DIR "/tests/data/booksim2.csv");
  std::vector<BookSimRow> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#') || line.starts_with("pipeline")) continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream in(line);
    BookSimRow& row = rows.emplace_back();
    in >> row.pipeline >> row.pattern >> row.resources >> row.flits >> row.routers >> row.latency;
  }
  return rows;
}

Config config_of(const BookSimRow& row) {
  Pattern pattern{};
  for (const auto& one : kEnumNames<Pattern>)
    if (one.name == row.pattern) pattern = one.value;
  Config c = traffic_config(Shape::kBidirectional, row.resources, pattern, 0.001, 40000);
  if (row.pipeline == "default") {
    c.topology.link.latency_cycles = 6;
    c.workload.traffic.inject_cycles = 4;
  }
  c.workload.traffic.packet_bytes = row.flits * c.topology.link.bytes_per_cycle;
  return c;
}

TEST(TrafficValidation, TakesAsLongAsBookSim2) {
  const std::vector<BookSimRow> rows = booksim_rows();
  ASSERT_EQ(rows.size(), 6u);
  for (const BookSimRow& row : rows) {
    SCOPED_TRACE(fmt::format("{} {} {} flits {}", row.pipeline, row.pattern, row.resources, row.flits));
    const Config config = config_of(row);
    const TrafficResult ours = run_traffic(config, {});
    const double hop = static_cast<double>(config.topology.link.latency_cycles);
    // 4 (R - 1) + 6 + (L - 1), or 6 R + 1, at our own R.
    const double closed = ours.zero_load_latency(config.workload.traffic);
    EXPECT_NEAR(
        closed,
        row.pipeline == "short" ? 4 * (ours.routers_mean() - 1) + 5 + double(row.flits) : 6 * ours.routers_mean() + 1,
        1e-9);
    EXPECT_NEAR(ours.latency.mean(), closed, 0.002 * closed);
    // BookSim2's at the same R. Its runs had some load: its 4-flit packets took 0.5 % longer than alone.
    const double theirs = row.latency + hop * (ours.routers_mean() - row.routers);
    EXPECT_NEAR(ours.latency.mean(), theirs, 0.006 * theirs);
    if (row.flits == 1) {
      EXPECT_NEAR(ours.latency.mean(), theirs, 0.002 * theirs);
    }
    fmt::print(
        "{:<8} {:<9} k {:>2}, {} flits: R {:.4f}, {:.4f} cycles, closed form {:.4f}, BookSim2 at this R {:.4f}\n",
        row.pipeline, row.pattern, row.resources, row.flits, ours.routers_mean(), ours.latency.mean(), closed, theirs);
    if (row.pattern != "neighbour") continue;
    EXPECT_EQ(ours.latency.mean(), 10.0);
    EXPECT_EQ(ours.latency.max(), 10u);
  }
}

TEST(TrafficValidation, SaturatesBelowTheBoundOfTheLinks) {
  // Uniform packets, their source among the destinations, cross (k - 1) / 2 links of a one-way ring, so k links carry
  // at most 2 / (k - 1) packets a resource and cycle. A place is taken for a round trip of the credit, 2 * 4 cycles:
  // with d places a link is busy for d / 8 of the time at most.
  for (const std::int64_t k : {8, 16}) {
    const double bound = 2.0 / static_cast<double>(k - 1);
    double last = 0;
    for (const std::int64_t depth : {4, 8, 16}) {
      for (const Flow flow : {Flow::kBubble, Flow::kCredits}) {
        Config c = traffic_config(Shape::kRing, k, Pattern::kUniform, 0.9, 400000);
        c.topology.link.depth = depth;
        c.topology.flow = flow;
        const TrafficResult r = run_traffic(c, {});
        const double accepted = static_cast<double>(r.accepted) /
                                (static_cast<double>(r.window_end - r.window_begin) * static_cast<double>(k));
        EXPECT_LE(accepted, 1.005 * bound);  // the ways drawn are a little shorter or longer
        EXPECT_LE(accepted, 1.005 * bound * static_cast<double>(depth) / 8);
        fmt::print("k {:>2} depth {:>2} {:<7}: {:.5f} packets per resource and cycle, bound {:.5f}: {:.1f} %\n", k,
                   depth, enum_name(flow), accepted, bound, 100 * accepted / bound);
        if (flow != Flow::kBubble) continue;
        EXPECT_GE(accepted, last);
        last = accepted;
        if (depth == 16) {
          EXPECT_GE(accepted, 0.9 * bound);
        }
      }
    }
  }
}

// The first packet of a queue holds up packets that could leave in other directions, so a source with one queue for all
// of them leaves links idle (M. Karol, M. Hluchyj, S. Morgan, Input versus output queueing on a space-division packet
// switch, IEEE Trans. Communications 35 (1987)). With a queue a direction the links are the limit, as in the closed
// form.
TEST(TrafficValidation, AQueueADirectionReachesTheBoundOfTheLinks) {
  for (const char* network : {"{shape: bidirectional, resources: 8}", "{shape: bidirectional, resources: 16}",
                              "{shape: multi_ring, rings: 2, resources: 16}"}) {
    for (const char* flow : {"bubble", "credits"}) {
      const auto part_of_links = [&](const char* queues) {
        Config c = load_config({fmt::format("engine: {{kind: cycle}}\ntopology: {}\nworkload: {{traffic: {{rate: 1.0, "
                                            "packets: 200000, source_queues: {}}}}}\n",
                                            network, queues),
                                "saturated.yaml"},
                               std::array{std::string("topology.flow=") + flow})
                       .config;
        return run_traffic(c, {}).accepted_of_links();
      };
      const double shared = part_of_links("shared"), apart = part_of_links("per_direction");
      fmt::print("{} {}: {:.1f} % of the links' time with one queue, {:.1f} % with a queue a direction\n", network,
                 flow, 100 * shared, 100 * apart);
      EXPECT_LT(shared, 0.87);
      EXPECT_GT(apart, 0.97);
      EXPECT_LE(apart, 1.005);  // some packets delivered were on their way when the window began
    }
  }
}

}  // namespace
}  // namespace carousel::ringbus
