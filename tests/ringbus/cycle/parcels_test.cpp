// Caches, memories and shading that are drawn: times against closed forms and against the same machine with side wires.
#include <map>

#include <gtest/gtest.h>

#include "ringbus/cycle/parcels/line_turns.h"
#include "ringbus/cycle/parcels/link_time.h"
#include "ringbus/cycle/parcels/shared_link.h"
#include "tests/ringbus/support/timed_machine.h"
#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus::cycle::parcels_test {
namespace {

TEST(LinkTime, MovesItsWidthACycle) {
  LinkTime time(32);
  EXPECT_EQ(time.parcel(16, 10).tail, 10u);  // half of cycle 10
  EXPECT_EQ(time.parcel(16, 10).head, 10u);  // the other half
  const LinkTime::Passage whole = time.parcel(100, 10);
  EXPECT_EQ(whole.head, 11u);
  EXPECT_EQ(whole.tail, 14u);  // 100 of 128 bytes
  EXPECT_EQ(time.queue().packet_cycles, 1u);
  EXPECT_EQ(time.packet(2, 9), 15u);  // begins with a cycle
  EXPECT_EQ(time.busy(), 7u);
  EXPECT_EQ(time.busy(16), 6u);
  EXPECT_EQ(time.parcel(1, 30).tail, 30u);
  EXPECT_EQ(time.busy(), 8u);
  EXPECT_EQ(time.parcels(), 4u);
  EXPECT_EQ(time.bytes(), 133u);
}

TEST(LineTurns, NumbersTheLinesOfEachNodeWithoutGaps) {
  for (const std::uint64_t nodes : {1, 2, 3, 8})
    for (const std::uint64_t lines : {1, 4, 5}) {
      const LineTurns turns(nodes, lines);
      std::map<std::uint64_t, std::uint64_t> next;
      for (std::uint64_t line = 0; line < 3 * nodes * lines; ++line) {
        const std::uint64_t node = turns.node_of(line);
        EXPECT_EQ(node, line / lines % nodes);
        EXPECT_EQ(turns.local(line), next[node]++);
        EXPECT_EQ(turns.global(node, turns.local(line)), line);
      }
    }
}

/// The link from r[0] to r[1] of a line of three, with a latency of 9 cycles.
class SharedLinkTest : public testing::Test {
 protected:
  static TopologyConfig line() {
    return load_config({"scene: {builtin: cornell}\nengine: {kind: cycle}\ntopology: {shape: graph, nodes: [{name: r, "
                        "count: 3}], links: [{line: 'r[*]', both: true, latency_cycles: 9}]}\n",
                        "line.yaml"})
        .config.topology;
  }
  void send_packet(Cycle start, std::uint16_t stop, std::uint32_t cycles) {
    Token token{PacketId(0)};
    token.stop = stop;
    token.link_cycles = cycles;
    near_.packets.send(start + 1 + (stop == 1 ? cycles - 1 : 0), token);  // passes through r[1], or ends there
  }

  const Topology topology_{line()};
  LooseWire near_, far_;
  LooseChannel<Parcel> in_, out_;
  SharedLink link_{topology_, 0, {&near_, &far_, &in_, &out_}};
};

TEST_F(SharedLinkTest, PacketsAloneTravelAsIfItWereNotThere) {
  ASSERT_EQ(topology_.wires()[0].to, ResourceId(1));
  send_packet(20, 2, 4);
  send_packet(24, 1, 3);
  send_packet(30, 2, 2);
  link_.run(1000);
  for (const Cycle arrival : {20 + 9, 24 + 9 + 2, 30 + 9}) {
    ASSERT_EQ(far_.packets.next(), arrival);
    far_.packets.take(arrival + 8);
    link_.run(1000);
    EXPECT_EQ(near_.packets.next_return(), arrival + 9);  // as on any link
    near_.packets.take_return();
  }
  EXPECT_EQ(link_.time().busy(), 9u);
}

TEST_F(SharedLinkTest, PacketsAndParcelsShareTheTime) {
  Parcel parcel;
  parcel.size_bytes = 64;
  send_packet(20, 2, 4);  // comes first, and takes 4 cycles from 21 on, a cycle behind its start
  in_.send(22, parcel);
  in_.send(22, parcel);
  send_packet(24, 2, 4);
  link_.run(1000);
  EXPECT_EQ(far_.packets.next(), 21u + 8);
  far_.packets.take(100);
  EXPECT_EQ(out_.next(), 26u + 8);  // cycles 25 and 26
  out_.take();
  EXPECT_EQ(out_.next(), 28u + 8);
  EXPECT_EQ(far_.packets.next(), 29u + 8);
  EXPECT_EQ(link_.time().busy(), 12u);
}

const std::string kSmall =
    "rays: {slots_per_resource: 32}\npackets: {rays: 8}\ncollections: {ready: 8}\n"
    "shading: {workers: 4, cycles_per_shade: 3}\n";

/// A ring of four resources, whose memory has wires of its own or these nodes and links.
std::string machine(const std::string& nodes, const std::string& links, const std::string& memory) {
  return kSmall + "memory: {l2_kib: 4, ways: 4, shape_buffer_kib: 2, " + memory +
         "}\ntopology:\n  shape: graph\n  nodes:\n    - {name: r, count: 4}\n" + nodes +
         "  links:\n    - {ring: 'r[*]', latency_cycles: 12}\n" + links;
}
std::string nodes_of_memory(const std::string& cache = "", const std::string& memory = "") {
  return "    - {name: l2, kind: cache" + cache + "}\n    - {name: dram, kind: memory" + memory + "}\n";
}
/// To one cache, and from there to one memory: `rest` of each.
std::string star(const std::string& to_cache, const std::string& to_memory) {
  return "    - {from: 'r[*]', to: l2, both: true, carries: [shapes], " + to_cache +
         "}\n    - {from: l2, to: dram, both: true, carries: [shapes], " + to_memory + "}\n";
}

void expect_same(const RunResult& a, const RunResult& b) {
  EXPECT_EQ(a.cycle->cycles, b.cycle->cycles);
  EXPECT_EQ(a.cycle->epochs.digests, b.cycle->epochs.digests);
  EXPECT_EQ(a.cycle->caches, b.cycle->caches);
  EXPECT_EQ(a.cycle->own_caches, b.cycle->own_caches);
  EXPECT_EQ(a.cycle->memory, b.cycle->memory);
  EXPECT_EQ(a.cycle->cached_lines, b.cycle->cached_lines);
}

/// Links have in their rows what the ledger counts on them.
void expect_rows_of_links(const CycleResult& result) {
  std::uint64_t rows = 0, ledger = 0;
  for (const LinkUse& link : result.links) {
    rows += link.bytes;
    EXPECT_LE(link.use.busy + link.use.stalled, result.cycles);
    EXPECT_GE(link.use.busy * 65536, link.bytes);
  }
  for (const ByteRow& row : result.bytes)
    if (row.what == "packets" || row.what == "messages on links") ledger += row.bytes;
  EXPECT_EQ(rows, ledger);
}

TEST(DrawnMemory, IsThatOfSideWiresWhenItsLinksAreAsLongAndNeverBusy) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 250, 1);
  const std::string wide = "bytes_per_cycle: 65536, latency_cycles: ";
  // Half of a latency, the link and the cycle from it to the cache are as long as half of the other latency.
  for (const std::string rest : {"", "l1_kib: 1, l1_latency_cycles: 6, ", "l2_banks: 2, l2_mshrs: 3, l2_write: back, ",
                                 "dram: {preset: gddr6_14, channels: 1}, "}) {
    SCOPED_TRACE(rest);
    const Outcome side = run_text(scene, machine("", "", rest + "l2_latency_cycles: 40, dram_latency_cycles: 60"));
    const std::string drawn = machine(nodes_of_memory(), star(wide + "9", wide + "19"),
                                      rest + "l2_latency_cycles: 20, dram_latency_cycles: 20");
    const Outcome there = run_text(scene, drawn);
    expect_same(side.result, there.result);
    EXPECT_EQ(run_text(scene, drawn, {}, 3).result.cycle->cycles, side.result.cycle->cycles);
    // Spilled entries are written as well.
    const std::vector<std::string> spills{"collections.when_full=spill", "collections.capacity=64"};
    const Outcome a = run_text(scene, machine("", "", rest + "l2_latency_cycles: 40, dram_latency_cycles: 60"), spills),
                  b = run_text(scene, drawn, spills);
    expect_same(a.result, b.result);
    EXPECT_GT(a.spilled, 0u);
  }
}

TEST(DrawnMemory, AReadTakesTheTimeOfItsWay) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 60, 1);
  // One ray at a time, which asks for one strip at a time, and a router on the way.
  const auto run = [&](int latency, int width, int node) {
    return run_text(scene, fmt::format("rays: {{slots_per_resource: 1}}\npackets: {{rays: 1}}\n"
                                       "collections: {{ready: 1, traversal: ordered}}\nshading: {{workers: 1}}\n"
                                       "memory: {{l2_kib: 64, shape_buffer_kib: 2, shape_stay: while_used, "
                                       "fetch_ahead: 0}}\ntopology:\n  shape: graph\n  nodes:\n    - {{name: r}}\n"
                                       "    - {{name: x, kind: router, latency_cycles: {2}}}\n"
                                       "    - {{name: l2, kind: cache}}\n  links:\n"
                                       "    - {{line: 'r, x, l2', both: true, latency_cycles: {0}, "
                                       "bytes_per_cycle: {1}, carries: [shapes]}}\n",
                                       latency, width, node))
        .result;
  };
  const RunResult plain = run(5, 65536, 0);
  const std::uint64_t requests = plain.cycle->caches.front().requests, cycles = plain.cycle->cycles;
  ASSERT_GT(requests, 300u);
  EXPECT_EQ(run(15, 65536, 0).cycle->cycles, cycles + 2 * 2 * 10 * requests);
  EXPECT_EQ(run(5, 65536, 7).cycle->cycles, cycles + 2 * 7 * requests);
  // A request of 16 bytes takes two cycles instead of one, and an answer a cycle for 8 bytes; the router sends them on
  // as soon as their heads have come.
  const std::uint64_t bytes = 64 * plain.cycle->caches.front().lines;
  EXPECT_EQ(run(5, 8, 0).cycle->cycles, cycles + bytes / 8 - requests + requests);
  // The links' rows have all bytes: the requests', and the lines' back.
  for (const std::size_t link : {0, 2}) EXPECT_EQ(plain.cycle->links[link].bytes, 16 * requests);
  for (const std::size_t link : {1, 3}) EXPECT_EQ(plain.cycle->links[link].bytes, bytes);
  EXPECT_EQ(plain.links[1].statistics.packets, requests);
}

TEST(DrawnMemory, ASlowerLinkIsSlower) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 600, 1);
  const auto cycles = [&](const std::string& to_memory) {
    return cycles_of(scene, machine(nodes_of_memory(), star("latency_cycles: 5", to_memory), "l2_latency_cycles: 20"));
  };
  const std::uint64_t wide = cycles("latency_cycles: 5"), late = cycles("latency_cycles: 105"),
                      narrow = cycles("latency_cycles: 5, bytes_per_cycle: 2");
  EXPECT_GT(late, wide * 11 / 10);
  EXPECT_GT(narrow, wide * 11 / 10);
}

TEST(DrawnMemory, BanksHoldTheLinesInTurn) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 200, 1);
  for (const std::string rest : {"", "l1_kib: 1, ", "l2_write: back, l2_sector_bytes: 32, "})
    for (const std::string turn : {"", ", interleave_bytes: 256"}) {
      const std::string text = machine(nodes_of_memory(", count: 3" + turn, ", count: 2"),
                                       "    - {from: 'r[*]', all_to: 'l2[*]', both: true, carries: [shapes]}\n"
                                       "    - {from: 'l2[*]', all_to: 'dram[*]', both: true, carries: [shapes]}\n",
                                       rest + "l2_latency_cycles: 20");
      SCOPED_TRACE(text);
      const Outcome out = run_text(scene, text, {"collections.when_full=spill", "collections.capacity=64"});
      EXPECT_GT(out.spilled, 0u);
      ASSERT_EQ(out.result.cycle->caches.size(), 3u);
      for (const CacheCounts& cache : out.result.cycle->caches) EXPECT_GT(cache.lines, 300u);
      EXPECT_EQ(out.result.cycle->memories, 2u);
      EXPECT_EQ(
          run_text(scene, text, {"collections.when_full=spill", "collections.capacity=64"}, 4).result.cycle->cycles,
          out.result.cycle->cycles);
    }
}

TEST(DrawnMemory, PacketsAndShapesGetInEachOthersWay) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 600, 1);
  const auto text = [](const std::string& links) {
    return kSmall +
           "memory: {l2_kib: 4, ways: 4, l2_latency_cycles: 20}\ntopology:\n  shape: graph\n"
           "  link: {latency_cycles: 3, bytes_per_cycle: 16}\n  nodes:\n    - {name: r, count: 4}\n"
           "    - {name: l2, kind: cache}\n  links:\n" +
           links;
  };
  const Outcome shared = run_text(scene, text("    - {ring: 'r[*], l2', carries: [packets, shapes]}\n")),
                apart = run_text(scene, text("    - {ring: 'r[*], l2'}\n"
                                             "    - {ring: 'r[*], l2', carries: [shapes]}\n"));
  EXPECT_GT(shared.result.cycle->cycles, apart.result.cycle->cycles);
  ASSERT_EQ(shared.result.links.size(), 5u);
  ASSERT_EQ(apart.result.links.size(), 10u);
  std::uint64_t packets = 0, both = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    packets += apart.result.cycle->links[i].bytes;
    both += shared.result.cycle->links[i].bytes;
  }
  EXPECT_GT(both, packets);
  for (const Outcome* out : {&shared, &apart}) expect_rows_of_links(*out->result.cycle);
  EXPECT_EQ(run_text(scene, text("    - {ring: 'r[*], l2', carries: [packets, shapes]}\n"), {}, 4).result.cycle->cycles,
            shared.result.cycle->cycles);
}

// Two links between the same nodes, one for packets and one for shapes, take the time of links between others.
TEST(DrawnMemory, ALinkForShapesStandsBesideOneForPackets) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 300, 1);
  const auto run = [&](const std::string& node, const std::string& rest) {
    return run_text(scene, kSmall +
                               "memory: {l2_kib: 4, ways: 4, l2_latency_cycles: 20}\ntopology:\n  shape: graph\n"
                               "  link: {latency_cycles: 3, bytes_per_cycle: 16}\n  nodes:\n    - {name: r, count: 3}\n"
                               "    - {name: x, kind: router, count: 2, latency_cycles: 1}\n"
                               "    - {name: l2, kind: cache}\n  links:\n    - {from: 'r[*]', to: 'x[0]', both: true}\n"
                               "    - {from: 'r[*]', to: '" +
                               node + "', both: true, carries: [shapes]}\n    - {from: l2, to: '" + node +
                               "', both: true, carries: [shapes]}\n" + rest);
  };
  // The other router is there both times, and moves nothing the first time.
  const std::string idle = "    - {from: 'r[0]', to: 'x[1]', both: true, latency_cycles: 1000}\n";
  const Outcome beside = run("x[0]", idle), apart = run("x[1]", idle);
  expect_same(beside.result, apart.result);
  expect_rows_of_links(*beside.result.cycle);
  EXPECT_GT(beside.result.cycle->caches.front().requests, 300u);
}

TEST(DrawnMemory, ALinkThatIsSharedHasTwoCyclesAtLeast) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 200, 1);
  const std::string text = kSmall +
                           "topology:\n  shape: graph\n  nodes: [{name: r, count: 2}, {name: l2, kind: cache}]\n"
                           "  links: [{ring: 'r[*], l2', latency_cycles: 2, carries: [packets, shapes]}]\n";
  Cell cell;
  cell.config = load_config({"scene: {builtin: cornell}\nengine: {kind: cycle}\n" + text, "machine.yaml"}).config;
  const Outcome two = run_cell(scene, cell);
  cell.config.topology.links[0].latency_cycles = 1;  // as the search for the bottleneck does, without the rules
  const Outcome one = run_cell(scene, cell);
  EXPECT_EQ(one.fault + two.fault, "");
  EXPECT_EQ(one.result.cycle->cycles, two.result.cycle->cycles);
}

TEST(DrawnShading, IsThatOfSideWiresWhenItsLinksAreAsLongAndNeverBusy) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 600, 1);
  const auto text = [](const std::string& nodes, const std::string& links) {
    return kSmall + "topology:\n  shape: graph\n  nodes:\n    - {name: r, count: 4}\n" + nodes +
           "  links:\n    - {ring: 'r[*]', latency_cycles: 12}\n" + links;
  };
  const Outcome side = run_text(scene, text("", ""), {"topology.link.latency_cycles=12"});
  const std::string pool = "    - {name: pool, kind: shading}\n";
  const auto star = [](const std::string& carries, int latency) {
    return fmt::format(
        "    - {{from: pool, to: 'r[*]', both: true, carries: [{}], bytes_per_cycle: 65536, "
        "latency_cycles: {}}}\n",
        carries, latency);
  };
  const std::vector<std::string> hop{"topology.link.latency_cycles=4"};
  const Outcome there = run_text(scene, text(pool, star("new_rays, completed_rays", 7)), hop);
  expect_same(side.result, there.result);
  EXPECT_EQ(there.result.cycle->links.size(), 12u);
  expect_rows_of_links(*there.result.cycle);
}

TEST(DrawnShading, ARayTakesTheTimeOfItsWay) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 60, 1);
  // One ray at a time.
  const auto run = [&](const std::string& carries, int latency, int width) {
    return run_text(scene, fmt::format("rays: {{slots_per_resource: 1}}\npackets: {{rays: 1}}\n"
                                       "collections: {{ready: 1, traversal: ordered}}\nshading: {{workers: 1}}\n"
                                       "memory: {{fetch_ahead: 0}}\ntopology:\n  shape: graph\n"
                                       "  nodes: [{{name: r}}, {{name: pool, kind: shading}}]\n"
                                       "  links: [{{from: pool, to: r, both: true, carries: [{}], "
                                       "latency_cycles: {}, bytes_per_cycle: {}}}]\n",
                                       carries, latency, width))
        .result;
  };
  const RunResult both = run("new_rays, completed_rays", 7, 65536), half = run("new_rays", 7, 65536);
  const std::uint64_t rays = both.rays_completed;
  ASSERT_GT(rays, 60u);
  EXPECT_EQ(run("new_rays, completed_rays", 70, 65536).cycle->cycles, both.cycle->cycles + 2 * 63 * rays);
  EXPECT_EQ(run("new_rays", 70, 65536).cycle->cycles, half.cycle->cycles + 63 * rays);
  EXPECT_EQ(both.cycle->cycles, half.cycle->cycles + 8 * rays);  // the link and the cycle from it
  // 68 bytes there, a record and a number, and 64 back.
  EXPECT_EQ(run("new_rays, completed_rays", 7, 8).cycle->cycles, both.cycle->cycles + (8 + 7) * rays);
  EXPECT_EQ(both.cycle->links[0].bytes, 68 * rays);
  EXPECT_EQ(both.cycle->links[1].bytes, 64 * rays);
}

}  // namespace
}  // namespace carousel::ringbus::cycle::parcels_test
