// Rings whose stops have no queues, joined by routers and links: closed forms, conservation, hits, and the verdict.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/system/error.h"
#include "ringbus/cycle/traffic/traffic_engine.h"
#include "ringbus/topology/graph_facts.h"
#include "ringbus/topology/wire_length.h"
#include "tests/ringbus/rings/ring_run.h"
#include "tests/ringbus/support/timed_machine.h"
#include "tests/ringbus/traffic/created_packets.h"
#include "tests/support/random_runs.h"

namespace carousel::ringbus::rings_that_meet_test {
namespace {

using testing::HasSubstr;

/// Two rings of four and three resources. Both have a stop at the router x, whose keys these are.
std::string met(const std::string& rings, const std::string& router = "") {
  return fmt::format(
      "topology:\n  shape: graph\n  link: {{depth: 2}}\n  nodes: [{{name: a, count: 4}}, {{name: b, count: 3}}, "
      "{{name: x, kind: router{}}}]\n  links:\n    - {{ring: 'a[*], x', {}}}\n    - {{ring: 'b[0], b[1], x, b[2]', "
      "{}}}\n",
      router, rings, rings);
}

Config traffic(const std::string& topology, const std::string& keys, const std::string& more = "") {
  return ring_config("engine: {kind: cycle}\n" + more + topology + "workload: {traffic: {warmup_fraction: 0, " + keys +
                     "}}\n");
}

struct Way {
  const char *from, *to;
  std::uint64_t a, x, b;  // hops of the rings with both directions, and visits of x
};

// A flit has a cycle to the ring and one from it, and a packet is whole where it gets off.
TEST(RingsThatMeet, APacketAloneTakesTheClosedForm) {
  const Way ways[] = {{"a[0]", "a[2]", 2, 0, 0},
                      {"a[3]", "b[1]", 1, 1, 1},
                      {"a[1]", "b[0]", 2, 1, 2},
                      {"b[2]", "a[2]", 2, 1, 1},
                      {"b[0]", "b[2]", 0, 0, 1}};
  for (const std::uint64_t flits : {1u, 3u})
    for (const std::uint64_t port : {1u, 2u})
      for (const Way& way : ways) {
        SCOPED_TRACE(fmt::format("{} to {}, {} flits, port of {}", way.from, way.to, flits, port));
        const Config config = traffic(
            met(fmt::format("both: true, latency_cycles: 5, stops: {{rule: slots, rings: 2, port_bytes_per_cycle: {}}}",
                            32 / port),
                ", latency_cycles: 3"),
            fmt::format("sources: '{}', destinations: '{}', rate: 0.0001, packets: 40, packet_bytes: {}, "
                        "inject_cycles: 4, eject_cycles: 6",
                        way.from, way.to, 32 * flits));
        const TrafficResult result = run_traffic(config, {});
        const auto over = [&](std::uint64_t hops) { return 1 + flits * port - 1 + 5 * hops + port - 1 + 1; };
        const std::uint64_t expected =
            4 + (way.a > 0 ? over(way.a) : 0) + 3 * way.x + (way.b > 0 ? over(way.b) : 0) + 6;
        EXPECT_EQ(result.latency.quantile(0), expected);
        EXPECT_EQ(result.latency.max(), expected);
        EXPECT_DOUBLE_EQ(result.zero_load_latency(config.workload.traffic), static_cast<double>(expected));
        EXPECT_EQ(result.flit_hops, 40 * flits * (way.a + way.b + 2 * (1 + way.x)));
        EXPECT_EQ(result.stops->extra_rounds, 0u);
        std::uint64_t packets = 0;
        for (std::size_t i = 0; i < result.links.size(); ++i) {  // the ports of both rings, which are nodes 8 and 9
          if (result.links[i].from < 8 && result.links[i].to < 8) continue;
          EXPECT_EQ(result.links[i].use.busy, result.link_packets[i] * flits * port);
          packets += result.link_packets[i];
        }
        EXPECT_EQ(packets, 40 * 2 * (1 + way.x));
      }
}

// A link between the doors of two rings, as wide as a port: from a[0] two hops, 1 + (F - 1 + 2 * 2) + 1, then the
// door's cycles and the link's with the tail behind the head, then the other ring, where b[0] is a hop from its door.
TEST(RingsThatMeet, ALinkBetweenThemAddsItsCycles) {
  const auto latency = [](const std::string& link, const std::string& clocks = "") {
    const Config config = traffic(
        "topology:\n  shape: graph\n  nodes: [{name: a, count: 3}, {name: b, count: 3}, {name: x, kind: router, count: "
        "2, latency_cycles: 1}]\n  links:\n    - {ring: 'a[*], x[0]', latency_cycles: 2, stops: {rule: slots}}\n    - "
        "{ring: 'x[1], b[*]', latency_cycles: 2, stops: {rule: grants, grant_cycles: 3}}\n    - {from: 'x[0]', to: "
        "'x[1]', both: true, latency_cycles: 20" +
            link + "}\n",
        "sources: 'a[1]', destinations: 'b[0]', rate: 0.0001, packets: 10, packet_bytes: 128, inject_cycles: 0, "
        "eject_cycles: 0",
        clocks);
    const TrafficResult result = run_traffic(config, {});
    EXPECT_EQ(result.latency.max(), result.latency.quantile(0));
    EXPECT_NEAR(result.zero_load_latency(config.workload.traffic), result.latency.mean(), 1e-9);
    return result.latency.max();
  };
  const std::uint64_t first = 1 + (4 - 1 + 2 * 2) + 1, second = 1 + 3 + 2 + 4 - 1 + 1;
  EXPECT_EQ(latency(""), first + (1 + 20) + 1 + second);  // the second ring takes the packet's flits as they come
  // Another width is stored whole: 16 flits.
  EXPECT_EQ(latency(", bytes_per_cycle: 8"), first + (1 + 20 + 15) + 1 + second);
  EXPECT_EQ(latency("", "clocks: {noc: 1000, synchroniser_cycles: 9}\n"), latency(""));
}

TEST(RingsThatMeet, NothingIsLost) {
  for (const char* rings : {"both: true, stops: {rule: slots}", "latency_cycles: 2, stops: {rule: slots, rings: 2}",
                            "both: true, stops: {rule: slots, port_bytes_per_cycle: 8, fair_after_cycles: 30}",
                            "both: true, stops: {rule: grants, rings: 2, fair_after_cycles: 100}"})
    for (const char* pattern : {"uniform", "tornado", "bursty"}) {
      SCOPED_TRACE(fmt::format("{} {}", rings, pattern));
      const Config config =
          traffic(met(rings), fmt::format("pattern: {}, rate: 0.4, packets: 2000, packet_bytes: 96", pattern));
      RunOptions options;
      std::vector<TrafficResult> results;
      for (const std::size_t threads : {1u, 3u}) {
        options.threads = threads;
        results.push_back(run_traffic(config, options));
      }
      const TrafficResult &one = results[0], &two = results[1];
      EXPECT_EQ(one.delivered, 2000u);
      EXPECT_EQ(one.latency.count(), 2000u);
      EXPECT_EQ(one.cycles, two.cycles);
      EXPECT_EQ(one.flit_hops, two.flit_hops);
      EXPECT_EQ(one.latency.sum(), two.latency.sum());
      EXPECT_FALSE(traffic_verdict(config.topology).can_deadlock);
      // Packets to the own resource stay there; others get on at their ring, and those to the other ring once more.
      std::uint64_t starts = 0;
      for (std::uint32_t from = 0; from < 7; ++from)
        for (const std::uint32_t to : created_by(config, from).to)
          starts += from == to ? 0 : (from < 4) == (to < 4) ? 1 : 2;
      EXPECT_EQ(one.stops->starts, starts);
    }
}

// From a ring to one of a quarter of its width, where a packet of 64 bytes takes 8 cycles: the queue of x fills up, so
// that flits go round until there is a place. All come through in the time that the port of the second ring takes.
TEST(RingsThatMeet, AFullRouterLetsTrafficGoRound) {
  const auto run = [](const std::string& router) {
    const Config config = traffic(
        "topology:\n  shape: graph\n  link: {depth: 2}\n  nodes: [{name: a, count: 4}, {name: b, count: 3}, {name: x, "
        "kind: router" +
            router +
            "}]\n  links:\n    - {ring: 'a[*], x', both: true, stops: {rule: slots, rings: 2}}\n    - {ring: 'b[*], "
            "x', both: true, bytes_per_cycle: 8, stops: {rule: slots}}\n",
        "sources: 'a[*]', destinations: 'b[*]', rate: 0.5, packets: 1000, packet_bytes: 64");
    return run_traffic(config, {});
  };
  const TrafficResult few = run(", buffers: 5"), many = run("");
  EXPECT_EQ(few.delivered, 1000u);
  EXPECT_GT(few.stops->extra_rounds, 2 * many.stops->extra_rounds);
  EXPECT_GT(few.stops->longest_ride, many.stops->longest_ride);
  for (const TrafficResult* one : {&few, &many}) EXPECT_NEAR(static_cast<double>(one->cycles), 8000, 0.05 * 8000);
}

// Rings with stops and routers in a chain or a circle, as much traffic as gets in.
TEST(RingsThatMeet, StopWhereTheVerdictSaysSo) {
  const std::uint64_t seed = std::uint64_t{run_seed()} * 1'000'003;
  std::uint64_t x = seed + 1;
  const auto draw = [&](std::uint64_t many) {
    x = 6364136223846793005ull * x + 1442695040888963407ull;
    return (x >> 33) % many;
  };
  int safe = 0, unsafe = 0, stopped = 0;
  for (int i = scaled(120, 30); i > 0; --i) {
    const std::uint64_t rings = 2 + draw(3);
    const bool circle = rings > 2 && draw(2) == 0;
    std::string nodes, links;
    for (std::uint64_t ring = 0; ring < rings; ++ring) {
      const std::uint64_t stops = 2 + draw(3);
      nodes += fmt::format("{{name: r{}, count: {}}}, ", ring, stops);
      std::string members = fmt::format("r{}[*]", ring);
      if (ring > 0 || circle) members += fmt::format(", x[{}]", (ring + rings - 1) % rings);
      if (ring + 1 < rings || circle) members = fmt::format("x[{}], {}", ring, members);
      links += fmt::format("    - {{ring: '{}', both: {}, latency_cycles: {}, stops: {{rule: slots}}}}\n", members,
                           draw(2) == 0, 1 + draw(2));
    }
    const bool few = draw(3) > 0;
    nodes +=
        fmt::format("{{name: x, kind: router, count: {}{}}}", circle ? rings : rings - 1, few ? ", buffers: 6" : "");
    const Config config =
        traffic("topology:\n  shape: graph\n  link: {depth: 1}\n  nodes: [" + nodes + "]\n  links:\n" + links,
                fmt::format("rate: 1, packets: 4000, packet_bytes: {}", 32 * (1 + draw(4))));
    SCOPED_TRACE(links + nodes);
    const DeadlockVerdict verdict = traffic_verdict(config.topology);
    EXPECT_TRUE(few || !verdict.can_deadlock) << verdict.rule;
    bool ends = true;
    try {
      ends = run_traffic(config, {}).delivered == 4000u;
    } catch (const SimulationError& e) {
      EXPECT_THAT(e.what(), HasSubstr("ring"));
      ends = false;
    }
    EXPECT_TRUE(ends || verdict.can_deadlock) << verdict.rule;
    (verdict.can_deadlock ? unsafe : safe) += 1;
    stopped += ends ? 0 : 1;
  }
  fmt::print("{} called safe came to their end; {} unsafe, of which {} stopped\n", safe, unsafe, stopped);
  EXPECT_GT(safe, 0);
  EXPECT_GT(unsafe, 0);
  EXPECT_GT(stopped, 0);
}

class RaysOnRingsThatMeet : public testing::Test {
 protected:
  TestScene scene_{builtin_scene(BuiltinScene::kTerrain, 2000, 0), 60, 1};
  static constexpr const char* kSmall = "rays: {slots_per_resource: 32}\npackets: {rays: 8}\ncollections: {ready: 8}\n";
};

// run_text() compares hits, counts and conservation with the reference tracer.
TEST_F(RaysOnRingsThatMeet, HaveTheHitsOfTheReference) {
  for (const char* router : {"", ", buffers: 5", ", latency_cycles: 2, forward: whole"})
    for (const char* rings : {"both: true, stops: {rule: slots}", "latency_cycles: 2, stops: {rule: slots, rings: 2}",
                              "both: true, bytes_per_cycle: 8, stops: {rule: grants, fair_after_cycles: 100}"}) {
      if (std::string_view(rings).find("grants") != std::string_view::npos &&
          std::string_view(router) == ", buffers: 5")
        continue;
      SCOPED_TRACE(fmt::format("{}{}", rings, router));
      const std::string text = kSmall + met(rings, router);
      const Outcome one = run_text(scene_, text), two = run_text(scene_, text, {}, 3);
      const cycle::CycleResult& c = *one.result.cycle;
      EXPECT_EQ(c.cycles, two.result.cycle->cycles);
      EXPECT_EQ(c.links, two.result.cycle->links);
      // 2 wires for each of 9 stops, and the links between them; what gets on gets off.
      const Config config = ring_config("scene: {builtin: cornell}\nengine: {kind: cycle}\n" + text);
      const std::size_t between = stop_ring_wires(config.topology, 1).size();
      ASSERT_EQ(one.result.links.size(), 18 + between);
      std::uint64_t on[2] = {}, off[2] = {}, of_x = 0;
      for (std::size_t i = 0; i < 18; ++i) {
        const LinkResult& link = one.result.links[i];
        if (link.to.value >= 8) on[link.to.value - 8] += link.statistics.packets;
        if (link.from.value >= 8) off[link.from.value - 8] += link.statistics.packets;
        if (link.from.value == 7) of_x += link.statistics.packets;
      }
      EXPECT_GT(of_x, 0u);
      EXPECT_EQ(on[0], off[0]);
      EXPECT_EQ(on[1], off[1]);
      EXPECT_EQ(c.stops->starts, on[0] + on[1]);
    }
}

// As RingOfRays.TakesTheClosedForm: a ring in which all are neighbours, with 10 cycles, takes as long as a star whose
// links away have 11; a router between two takes the whole packet.
TEST_F(RaysOnRingsThatMeet, TakeTheClosedForm) {
  TestScene one(builtin_scene(BuiltinScene::kTerrain, 2000, 0), 1, 0);
  const auto alone = [&](const std::string& topology) {
    return cycles_of(one,
                     "packets: {rays: 1}\ncollections: {ready: 1, home: hash, when_full: spill, traversal: "
                     "ordered}\nrays: {slots_per_resource: 1}\n" +
                         topology);
  };
  const auto stars = [&](int latency) {
    return alone(fmt::format(
        "topology:\n  shape: graph\n  link: {{bytes_per_cycle: 4}}\n  nodes: [{{name: a, count: 2}}, {{name: b, count: "
        "2}}, {{name: x, kind: router, latency_cycles: 3, forward: whole}}, {{name: s, kind: router, count: 2}}]\n  "
        "links:\n    - {{from: 'a[*], x', to: 's[0]', latency_cycles: 1}}\n    - {{from: 's[0]', to: 'a[*], x', "
        "latency_cycles: {0}}}\n    - {{from: 'b[*], x', to: 's[1]', latency_cycles: 1}}\n    - {{from: 's[1]', to: "
        "'b[*], x', latency_cycles: {0}}}\n",
        latency));
  };
  const std::uint64_t rings = alone(
      "topology:\n  shape: graph\n  link: {bytes_per_cycle: 4}\n  nodes: [{name: a, count: 2}, {name: b, count: 2}, "
      "{name: x, kind: router, latency_cycles: 3}]\n  links:\n    - {ring: 'a[*], x', both: true, latency_cycles: 10, "
      "stops: {rule: slots}}\n    - {ring: 'b[*], x', both: true, latency_cycles: 10, stops: {rule: slots}}\n");
  EXPECT_EQ(rings, stars(11));
  EXPECT_NE(rings, stars(12)) << "no packet travels";
}

TEST_F(RaysOnRingsThatMeet, TheVerdictCountsWhatACircleHolds) {
  const auto verdict = [](const std::string& router, int depth) {
    Config config = ring_config("scene: {builtin: cornell}\nengine: {kind: cycle}\n" +
                                met("both: true, stops: {rule: slots}", router));
    config.topology.link.depth = depth;
    return Topology(config.topology).verdict();
  };
  EXPECT_FALSE(verdict("", 2).can_deadlock);
  EXPECT_THAT(verdict("", 2).rule, HasSubstr("no circle"));
  EXPECT_THAT(verdict("", 2).rule, HasSubstr("; slots: nothing waits on the ring"));
  // Each ring holds d + 1 packets before it, one, and 5 + d behind it: two hold 22 and 34 for d of 2 and 5, of which 7
  // resources put 14 and 35 on the way.
  EXPECT_TRUE(verdict(", buffers: 5", 5).can_deadlock);
  EXPECT_FALSE(verdict(", buffers: 5", 2).can_deadlock);
  EXPECT_THAT(verdict(", buffers: 5", 2).rule, HasSubstr("put 14 packets on the way, and the smallest circle of links "
                                                         "holds 22"));
  EXPECT_THAT(verdict(", buffers: 5", 2).rule, HasSubstr("a packet that finds no place at a router"));
}

}  // namespace
}  // namespace carousel::ringbus::rings_that_meet_test
