// Shapes and rays over links of several clocks, and memories that go by clocks of their own.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/ringbus/support/timed_machine.h"
#include "tests/ringbus/topology/random_graphs.h"

namespace carousel::ringbus::cycle::parcel_clocks_test {
namespace {

using graph_test::RandomGraph;

void expect_same(const RunResult& a, const RunResult& b) {
  EXPECT_EQ(a.cycle->cycles, b.cycle->cycles);
  EXPECT_EQ(a.cycle->epochs.digests, b.cycle->epochs.digests);
  EXPECT_EQ(a.cycle->caches, b.cycle->caches);
  EXPECT_EQ(a.cycle->memory, b.cycle->memory);
  ASSERT_EQ(a.cycle->links.size(), b.cycle->links.size());
  for (std::size_t i = 0; i < a.cycle->links.size(); ++i) {
    EXPECT_EQ(a.cycle->links[i].use.busy, b.cycle->links[i].use.busy) << i;
    EXPECT_EQ(a.cycle->links[i].use.stalled, b.cycle->links[i].use.stalled) << i;
    EXPECT_EQ(a.cycle->links[i].queue, b.cycle->links[i].queue) << i;
    EXPECT_EQ(a.cycle->links[i].bytes, b.cycle->links[i].bytes) << i;
  }
}

/// What holds for the links of any run.
void expect_ledger_of_links(const CycleResult& result) {
  std::uint64_t rows = 0, ledger = 0;
  for (const LinkUse& link : result.links) {
    rows += link.bytes;
    EXPECT_LE(link.use.busy + link.use.stalled, result.cycles);
  }
  for (const ByteRow& row : result.bytes)
    if (row.what == "packets" || row.what == "messages on links") ledger += row.bytes;
  EXPECT_EQ(rows, ledger);
}

// One ray at a time, which asks for one strip at a time. With a whole number of the link's cycles in one of the
// resources, or the other way round with ways that end at edges of both, each request waits equally long.
TEST(ParcelClocks, ARequestTakesTheCyclesOfItsWay) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 40, 1);
  const auto run = [&](const std::string& clocks, int latency, int width) {
    return run_text(scene, fmt::format("{}rays: {{slots_per_resource: 1}}\npackets: {{rays: 1}}\n"
                                       "collections: {{ready: 1, traversal: ordered}}\nshading: {{workers: 1}}\n"
                                       "memory: {{l2_kib: 64, shape_buffer_kib: 2, shape_stay: while_used, "
                                       "fetch_ahead: 0}}\ntopology:\n  shape: graph\n"
                                       "  nodes: [{{name: r}}, {{name: l2, kind: cache}}]\n"
                                       "  links: [{{from: r, to: l2, both: true, latency_cycles: {}, "
                                       "bytes_per_cycle: {}, carries: [shapes]}}]\n",
                                       clocks, latency, width))
        .result;
  };
  const RunResult plain = run("", 9, 65536);
  const std::uint64_t requests = plain.cycle->caches.front().requests, cycles = plain.cycle->cycles;
  ASSERT_GT(requests, 200u);
  for (const std::uint64_t times : {2, 3, 5})
    for (const std::uint64_t wait : {0, 1, 4}) {
      const std::string clocks = fmt::format("clocks: {{noc: {}, synchroniser_cycles: {}}}\n", 1000 * times, wait);
      const std::uint64_t way = ceil_div(wait + 9, times) + wait;
      EXPECT_EQ(run(clocks, 9, 65536).cycle->cycles, cycles + 2 * (way - 9) * requests) << clocks;
      // Two cycles for a request of 16 bytes.
      const RunResult narrow = run(clocks, 9, 8);
      EXPECT_EQ(narrow.cycle->links[0].bytes, 16 * requests);
      EXPECT_EQ(narrow.cycle->links[0].use.busy, 2 * requests / times);
      EXPECT_EQ(narrow.cycle->links[0].mhz, static_cast<std::int64_t>(1000 * times));
    }
}

/// A ring with a clock of its own, and a cache beside it: `carries` on the ring, on whose way no shape travels.
std::string ring(const std::string& clocks, const std::string& carries, int depth) {
  return fmt::format(
      "{}rays: {{slots_per_resource: 32}}\npackets: {{rays: 8}}\ncollections: {{ready: 8}}\nmemory: {{l2_kib: 4}}\n"
      "topology:\n  shape: graph\n  link: {{depth: {}}}\n"
      "  nodes: [{{name: r, count: 4}}, {{name: x, kind: router, latency_cycles: 2}}, {{name: l2, kind: cache}}]\n"
      "  links:\n    - {{ring: 'r[*], x', both: true, latency_cycles: 5, bytes_per_cycle: 16, carries: [{}]}}\n"
      "    - {{from: 'r[*]', to: l2, both: true, latency_cycles: 1, clock: core, carries: [shapes]}}\n",
      clocks, depth, carries);
}

TEST(ParcelClocks, PacketsAloneOnASharedLinkTravelAsOnOneOfTheirOwn) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 200, 1);
  for (const char* clocks :
       {"clocks: {noc: 1000}\n", "clocks: {noc: 1333}\n", "clocks: {noc: 300, synchroniser_cycles: 0}\n",
        "clocks: {noc: 3000, synchroniser_cycles: 5}\n", "clocks: {noc: 999, synchroniser_cycles: 1}\n"})
    for (const int depth : {2, 9}) {
      SCOPED_TRACE(fmt::format("{}, {} places", clocks, depth));
      expect_same(run_text(scene, ring(clocks, "packets, shapes", depth)).result,
                  run_text(scene, ring(clocks, "packets", depth)).result);
    }
}

TEST(ParcelClocks, LinksBetweenClocksHaveFaults) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 200, 1);
  const std::string faults = "faults: {links: {drop: 0.1, duplicate: 0.1, corrupt: 0.1, reorder: 0.1, delay: 0.3}}\n";
  expect_same(run_text(scene, faults + ring("", "packets", 3)).result,
              run_text(scene, faults + ring("clocks: {noc: 1000}\n", "packets", 3)).result);
  for (const char* clocks : {"clocks: {noc: 1333}\n", "clocks: {noc: 300, synchroniser_cycles: 0}\n",
                             "clocks: {noc: 3000, synchroniser_cycles: 5}\n"})
    for (const int depth : {1, 2, 9}) {
      SCOPED_TRACE(fmt::format("{}, {} places", clocks, depth));
      const RunResult one = run_text(scene, faults + ring(clocks, "packets", depth)).result;
      expect_same(one, run_text(scene, faults + ring(clocks, "packets", depth), {}, 3).result);
      expect_ledger_of_links(*one.cycle);
      LinkFaultCounts counts;
      for (const LinkResult& link : one.links) counts += link.faults;
      EXPECT_GT(counts.resent, 0u);
    }
}

/// Resources, routers and parts on a random graph, whose links, routers and memory go by clocks at random. What all
/// messages need is a tree, and other links carry a part.
std::string drawing(RandomGraph& graph) {
  const auto pick = [&](std::initializer_list<const char*> of) { return *(of.begin() + graph.draw(of.size())); };
  const auto clock = [&] { return pick({"", ", clock: core", ", clock: noc", ", clock: a", ", clock: b"}); };
  const std::uint64_t nodes = graph.nodes(), routers = graph.draw(3), resources = nodes - 3 - routers;
  std::string drawn = fmt::format("  nodes:\n    - {{name: r, count: {}}}\n", resources);
  if (routers > 0) {
    const std::uint64_t latency = graph.draw(3);
    drawn +=
        fmt::format("    - {{name: x, kind: router, count: {}, latency_cycles: {}{}}}\n", routers, latency, clock());
  }
  drawn += fmt::format("    - {{name: l2, kind: cache}}\n    - {{name: dram, kind: memory{}}}\n", clock());
  drawn += "    - {name: pool, kind: shading}\n  links:\n";
  const std::array<const char*, 3> parts{"l2", "dram", "pool"};
  const auto name = [&](std::uint64_t node) {
    if (node < resources) return fmt::format("r[{}]", node);
    return node + 3 < nodes ? fmt::format("x[{}]", node - resources) : std::string(parts[node + 3 - nodes]);
  };
  std::uint64_t number = 0;
  for (const RandomGraph::Link& link : graph.links()) {
    const char* carries = "packets, shapes, new_rays, completed_rays";
    if (++number >= nodes)
      carries = pick({carries, "packets", "shapes", "new_rays, completed_rays", "packets, shapes"});
    const char* const width = pick({"8", "32"});
    drawn += fmt::format(
        "    - {{from: '{}', to: '{}', both: true, latency_cycles: {}, bytes_per_cycle: {}, carries: [{}]{}}}\n",
        name(link.from), name(link.to), link.latency + 1, width, carries, clock());
  }
  std::string clocks = pick({"noc: 2000", "noc: 3000", "noc: 999"});  // and those alone that have a part
  if (drawn.find("clock: a") != std::string::npos) clocks += pick({", a: 700", ", a: 1001", ", a: 500"});
  if (drawn.find("clock: b") != std::string::npos) clocks += pick({", b: 1500", ", b: 6000", ", b: 40"});
  const std::uint64_t wait = graph.draw(4);
  return fmt::format("clocks: {{{}, synchroniser_cycles: {}}}\n", clocks, wait) +
         "rays: {slots_per_resource: 16}\npackets: {rays: 8}\ncollections: {ready: 8}\n" +
         fmt::format("memory: {{{}l2_kib: 4, ways: 4}}\n",
                     pick({"", "l1_kib: 1, ", "l2_write: back, ", "dram: {preset: gddr6_14, channels: 1}, "})) +
         "topology:\n  shape: graph\n  routes: up_down\n" + drawn;
}

// Any drawing finds the reference tracer's hits, and its cycles are the same on any number of threads.
TEST(ParcelClocks, RandomDrawingsFindTheHits) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 200, 0), 60, 2);
  const std::uint64_t seed = std::uint64_t{run_seed()} * 1'000'003;
  for (int i = cell_count(24); i > 0; --i) {
    RandomGraph graph(seed + static_cast<std::uint64_t>(i));
    const std::string text = drawing(graph);
    SCOPED_TRACE(text);
    const RunResult one = run_text(scene, text).result;
    expect_ledger_of_links(*one.cycle);
    expect_same(one, run_text(scene, text, {}, 3).result);
  }
}

}  // namespace
}  // namespace carousel::ringbus::cycle::parcel_clocks_test
