// Graphs on the native engine: the hits are those of the reference and of the cycle engine, and nothing stays behind.
#include <random>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/config/load/load.h"
#include "ringbus/protocol/deadlock.h"
#include "tests/ringbus/support/test_machine.h"

namespace carousel::ringbus::native_graph_test {
namespace {

Config machine(const std::string& topology, const std::string& more = "") {
  return load_config({"scene: {builtin: cornell}\npackets: {rays: 8}\ncollections: {ready: 8}\nrays: "
                      "{slots_per_resource: 32}\ntopology:\n  shape: graph\n" +
                          topology + more,
                      "graph.yaml"},
                     {}, {.force = true})
      .config;
}

const char* const kRing = "  nodes: [{name: r, count: 5}]\n  links: [{ring: 'r[*]'}]\n";
const char* const kClusters =
    "  nodes:\n    - {name: left, count: 4}\n    - {name: right, count: 4}\n"
    "    - {name: door, kind: router, count: 2}\n  links:\n    - {ring: 'left[*], door[0]'}\n"
    "    - {ring: 'right[*], door[1]', both: true}\n"
    "    - {from: 'door[0]', to: 'door[1]', both: true, depth: 4}\n";
const char* const kHierarchy =
    "  nodes:\n    - {name: a, count: 3}\n    - {name: b, count: 3}\n    - {name: hub, kind: router, count: 2}\n"
    "  links:\n    - {line: 'hub[0], a[*], hub[0]'}\n    - {line: 'hub[1], b[*], hub[1]'}\n"
    "    - {ring: 'hub[*]'}\n";
const char* const kTree =
    "  nodes: [{name: r, count: 6}]\n  links:\n    - {from: 'r[0]', to: 'r[1..2]', both: true, depth: 2}\n"
    "    - {from: 'r[1]', to: 'r[3..4]', both: true, depth: 2}\n    - {from: 'r[2]', to: 'r[5]', both: true, depth: "
    "2}\n";

class NativeGraph : public testing::Test {
 protected:
  TestScene scene_{builtin_scene(BuiltinScene::kCornell, 0, 0), 400, 2};

  void expect_whole(const Config& config, const std::string& what) {
    for (const std::size_t threads : {1u, 2u, 5u}) {
      Cell cell{config, threads};
      const Outcome out = run_cell(scene_, cell);
      EXPECT_EQ(out.fault, "") << what << ", " << threads << " threads";
    }
  }
};

TEST_F(NativeGraph, RunsTheDrawings) {
  for (const char* const drawing : {kRing, kClusters, kHierarchy, kTree})
    for (const char* const more :
         some(std::vector{"", "  visit: all\n", "  link: {depth: 1}\n", "  link: {depth: 64}\n", "  flow: bubble\n"},
              2)) {
      const Config config = machine(std::string(drawing) + more);
      if (!deadlock_verdict(config).can_deadlock) expect_whole(config, std::string(drawing) + more);
    }
}

TEST_F(NativeGraph, RoutersOfFewPlacesHoldPacketsUp) {
  std::string drawing(kClusters);
  drawing.replace(drawing.find("router, count: 2"), 16, "router, count: 2, buffers: 1");
  const Config config = machine(drawing + "  link: {depth: 64}\n");
  ASSERT_FALSE(deadlock_verdict(config).can_deadlock) << deadlock_verdict(config).rule;
  expect_whole(config, drawing);
}

TEST_F(NativeGraph, RunsWithFaultsOfLinksAndTravellingRays) {
  expect_whole(machine(kClusters, "faults: {links: {drop: 0.02, duplicate: 0.02}}\n"), "faults");
  Config travelling = machine(kClusters);
  travelling.rays.placement = Placement::kFirstTaker;
  expect_whole(travelling, "first_taker");
  Config hashed = machine(kHierarchy);
  hashed.collections.home = Home::kHash;
  hashed.collections.when_full = WhenFull::kSpill;
  expect_whole(hashed, "hash");
  Config ordered = machine(kTree);
  ordered.collections.traversal = Traversal::kOrdered;
  expect_whole(ordered, "ordered");
}

TEST_F(NativeGraph, GoesOnWithoutAResourceThatStops) {
  Config config = machine(kClusters, "faults: {resource: {kind: stop, number: 5, after_rays: 20}}\n");
  Cell cell{config, 2};
  const Outcome out = run_cell(scene_, cell);
  EXPECT_EQ(out.fault, "");
}

/// A tree over all nodes, so that there is a way between any two, and some links more.
std::string random_drawing(std::mt19937& random) {
  const auto pick = [&](std::uint32_t most) { return random() % most; };
  const std::uint32_t resources = 2 + pick(7), routers = pick(4), nodes = resources + routers;
  const auto name = [&](std::uint32_t n) {
    return n < resources ? fmt::format("r[{}]", n) : fmt::format("x[{}]", n - resources);
  };
  std::string text = fmt::format("  nodes:\n    - {{name: r, count: {}}}\n", resources);
  const std::string buffers = pick(2) == 0 ? "" : fmt::format(", buffers: {}", 1 + pick(3));
  if (routers > 0) text += fmt::format("    - {{name: x, kind: router, count: {}{}}}\n", routers, buffers);
  text += "  links:\n";
  std::vector<std::vector<bool>> linked(nodes, std::vector<bool>(nodes));
  const auto link = [&](std::uint32_t from, std::uint32_t to) {
    if (from == to || linked[from][to]) return;
    linked[from][to] = true;
    text += fmt::format("    - {{from: '{}', to: '{}', depth: {}, latency_cycles: {}}}\n", name(from), name(to),
                        1 + pick(4), 1 + pick(8));
  };
  for (std::uint32_t n = 1; n < nodes; ++n) {
    const std::uint32_t other = pick(n);
    link(n, other);
    link(other, n);
  }
  for (std::uint32_t more = pick(2 * nodes); more > 0; --more) link(pick(nodes), pick(nodes));
  return text + (pick(2) == 0 ? "" : "  visit: all\n") + fmt::format("  link: {{depth: {}}}\n", 1 + pick(16));
}

TEST_F(NativeGraph, RandomGraphsGiveTheHitsOfTheCycleEngine) {
  std::mt19937 random(48);
  int safe = 0;
  for (int i = 0; i < cell_count(60); ++i) {
    const std::string drawing = random_drawing(random);
    const Config config = machine(drawing);
    if (deadlock_verdict(config).can_deadlock) continue;
    ++safe;
    Cell cell{config, 1 + std::size_t{random() % 4}};
    EXPECT_EQ(run_cell(scene_, cell).fault, "") << drawing << deadlock_verdict(config).rule;
    if (i % 8 != 0) continue;
    cell.config.engine.kind = EngineKind::kCycle;  // both are held to the reference tracer
    EXPECT_EQ(run_cell(scene_, cell).fault, "") << drawing;
  }
  EXPECT_GT(safe, cell_count(60) / 4);
}

}  // namespace
}  // namespace carousel::ringbus::native_graph_test
