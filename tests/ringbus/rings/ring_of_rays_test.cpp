// Machines of rays on rings whose stops have no queues, with clocks of links and routers, and with resources that
// differ: the hits and counts of the reference tracer, and closed forms of time.
#include <gtest/gtest.h>

#include "tests/ringbus/support/timed_machine.h"

namespace carousel::ringbus::ring_of_rays_test {
namespace {

constexpr const char* kSmall = "rays: {slots_per_resource: 32}\npackets: {rays: 8}\ncollections: {ready: 8}\n";

std::string ring(const std::string& link, int stops = 5) {
  return fmt::format("topology: {{shape: graph, nodes: [{{name: r, count: {}}}], links: [{{ring: 'r[*]', {}}}]}}\n",
                     stops, link);
}

class RingOfRays : public testing::Test {
 protected:
  TestScene scene_{builtin_scene(BuiltinScene::kTerrain, 2000, 0), 60, 1};

  /// One ray, which goes depth first from home to home of the nodes, so that there is one packet at a time.
  std::uint64_t alone(const std::string& topology, const std::string& more = "") {
    TestScene one(builtin_scene(BuiltinScene::kTerrain, 2000, 0), 1, 0);
    return cycles_of(one,
                     "packets: {rays: 1}\ncollections: {ready: 1, home: hash, when_full: spill, traversal: "
                     "ordered}\nrays: {slots_per_resource: 1}\n" +
                         more + topology);
  }
};

// run_text() compares hits, counts and conservation with the reference tracer.
TEST_F(RingOfRays, HasTheHitsOfTheReference) {
  for (const char* stops :
       {"{rule: slots}", "{rule: slots, rings: 2, fair_after_cycles: 50}", "{rule: slots, port_bytes_per_cycle: 8}",
        "{rule: grants}", "{rule: grants, command_cycles: 2, transfers: 1, fair_after_cycles: 100}"})
    for (const char* both : {"true", "false"})
      for (const char* visit : {"owners", "all"}) {
        if (std::string_view(visit) == "all" && std::string_view(both) == "true") continue;
        SCOPED_TRACE(fmt::format("{} both: {} visit: {}", stops, both, visit));
        const std::string text = kSmall + ring(fmt::format("both: {}, latency_cycles: 2, stops: {}", both, stops));
        const std::vector<std::string> sets{fmt::format("topology.visit={}", visit)};
        const Outcome one = run_text(scene_, text, sets), two = run_text(scene_, text, sets, 3);
        EXPECT_EQ(one.result.cycle->cycles, two.result.cycle->cycles);
        EXPECT_EQ(one.result.cycle->links, two.result.cycle->links);
        std::uint64_t on = 0, off = 0;
        for (const LinkResult& link : one.result.links) {
          if (link.to.value == 5) on += link.statistics.packets;
          if (link.from.value == 5) off += link.statistics.packets;
        }
        EXPECT_GT(on, 0u);
        EXPECT_EQ(on, off);
        ASSERT_TRUE(one.result.cycle->stops);
        EXPECT_EQ(one.result.cycle->stops->starts, on);
      }
}

// With nobody in the way a packet of F flits takes 1 + (F - 1 + h latency) + 1 cycles on a ring, and over two links,
// the first of one cycle and with a router between them, 1 + latency + F - 1. So with links of 10 cycles between
// neighbours a machine takes as long as on a star with links of 11 cycles from its middle.
TEST_F(RingOfRays, TakesTheClosedForm) {
  const auto star = [&](int latency) {
    return fmt::format(
        "topology: {{shape: graph, link: {{bytes_per_cycle: 4}}, nodes: [{{name: r, count: 3}}, {{name: x, "
        "kind: router}}], links: [{{from: 'r[*]', to: x, latency_cycles: 1}}, {{from: x, to: 'r[*]', "
        "latency_cycles: {}}}]}}\n",
        latency);
  };
  const auto slots = [&](const std::string& stops, int latency) {
    return fmt::format(
        "topology: {{shape: graph, link: {{bytes_per_cycle: 4}}, nodes: [{{name: r, count: 3}}], links: "
        "[{{ring: 'r[*]', both: true, latency_cycles: {}, stops: {}}}]}}\n",
        latency, stops);
  };
  const std::uint64_t queued = alone(star(11));
  EXPECT_NE(alone(star(12)), queued) << "no packet travels";
  EXPECT_EQ(alone(slots("{rule: slots}", 10)), queued);
  EXPECT_EQ(alone(slots("{rule: grants, grant_cycles: 0}", 10)), queued);
  // A stop has one request, so that of two packets the second asks when the first has been granted its way.
  EXPECT_GE(alone(slots("{rule: grants, grant_cycles: 5}", 10)), alone(star(16)));
  EXPECT_GT(alone(slots("{rule: slots, port_bytes_per_cycle: 2}", 10)), queued);
  EXPECT_EQ(alone(slots("{rule: slots}", 10), "clocks: {noc: 1000, synchroniser_cycles: 9}\n"), queued);
  EXPECT_LT(alone(slots("{rule: slots}", 10), "clocks: {noc: 2000, synchroniser_cycles: 0}\n"), queued);
  EXPECT_GT(alone(slots("{rule: slots}", 10), "clocks: {noc: 500, synchroniser_cycles: 0}\n"), queued);
}

// The ports of the stops, to and from the ring, are as busy as a packet has bytes over their width, however slow their
// clock: with a byte a cycle, as its bytes say. Each packet gets on once, and off once.
TEST_F(RingOfRays, PortsAreBusyForTheBytesOfTheirPackets) {
  for (const char* rule : {"slots", "grants"})
    for (const char* clocks : {"", "clocks: {noc: 500, synchroniser_cycles: 1}\n"})
      for (const std::uint64_t width : {1u, 8u, 16u}) {
        SCOPED_TRACE(fmt::format("{} {} {}", rule, clocks, width));
        const cycle::CycleResult c =
            *run_text(scene_, clocks + std::string(kSmall) +
                                  ring(fmt::format("bytes_per_cycle: 16, latency_cycles: 2, stops: {{rule: {}, "
                                                   "port_bytes_per_cycle: {}}}",
                                                   rule, width)))
                 .result.cycle;
        const std::uint64_t slower = *clocks == 0 ? 1 : 2;  // cycles of the resources for one of the ring
        std::uint64_t on = 0, off = 0, packets = 0;
        for (const cycle::LinkUse& link : c.links) {
          EXPECT_LE(link.use.busy + link.use.stalled, c.cycles);
          if (link.from != 5 && link.to != 5) continue;
          (link.to == 5 ? on : off) += link.use.busy;
          EXPECT_GE(link.use.busy * width, slower * link.bytes);
          EXPECT_LE(width == 1 ? link.use.busy : 0, slower * link.bytes);
        }
        for (const cycle::LinkUse& link : c.links) packets += link.to == 5 ? link.bytes : 0;
        EXPECT_EQ(on, off);
        EXPECT_LT(on * width, slower * (packets + width * c.stops->starts));
      }
}

constexpr const char* kDomains =
    "topology:\n  shape: graph\n"
    "  nodes: [{name: a, count: 3}, {name: b, count: 3}, {name: x, kind: router, count: 2, latency_cycles: 2ROUTER}]\n"
    "  links:\n    - {ring: 'a[*], x[0]', both: true}\n    - {ring: 'b[*], x[1]', both: true}\n"
    "    - {from: 'x[0]', to: 'x[1]', both: true, latency_cycles: 9, bytes_per_cycle: 16LINK}\n";

std::string domains(const std::string& clocks, const std::string& router, const std::string& link) {
  std::string text = kDomains;
  text.replace(text.find("ROUTER"), 6, router);
  text.replace(text.find("LINK}"), 4, link);
  return clocks + kSmall + text;
}

TEST_F(RingOfRays, ClocksOfOneFrequencyAreOne) {
  const cycle::CycleResult one = *run_text(scene_, domains("", "", "")).result.cycle;
  const cycle::CycleResult two =
      *run_text(scene_, domains("clocks: {noc: 1000, a: 1000, synchroniser_cycles: 9}\n", ", clock: a", ", clock: a"))
           .result.cycle;
  EXPECT_EQ(one.cycles, two.cycles);
  EXPECT_EQ(one.links, two.links);
  EXPECT_EQ(one.epochs.digests, two.epochs.digests);
}

TEST_F(RingOfRays, SeveralClocksChangeTimeAndNothingElse) {
  const std::uint64_t one = run_text(scene_, domains("", "", "")).result.cycle->cycles;
  for (const char* clocks : {"clocks: {noc: 1333, slow: 400}\n", "clocks: {noc: 500, slow: 3000}\n",
                             "clocks: {noc: 999, slow: 1001, synchroniser_cycles: 0}\n"}) {
    const std::string text = domains(clocks, "", ", clock: slow");
    const Outcome two = run_text(scene_, text), threads = run_text(scene_, text, {}, 3);
    const cycle::CycleResult& c = *two.result.cycle;
    EXPECT_NE(c.cycles, one);
    EXPECT_EQ(threads.result.cycle->cycles, c.cycles);
    EXPECT_EQ(threads.result.cycle->links, c.links);
    for (const cycle::LinkUse& link : c.links) EXPECT_LE(link.use.busy + link.use.stalled, c.cycles);
  }
}

// A link of 200 of its cycles takes 100 of the resources' at twice their frequency, and each synchroniser its cycles.
TEST_F(RingOfRays, AWayTakesTheCyclesOfItsClock) {
  const auto at = [&](int latency, const std::string& clocks) {
    return alone(fmt::format("topology: {{shape: graph, nodes: [{{name: r, count: 2}}], links: [{{line: 'r[*]', both: "
                             "true, latency_cycles: {}}}]}}\n",
                             latency),
                 clocks);
  };
  const std::uint64_t near = at(100, ""), far = at(200, ""), links = (far - near) / 100;
  EXPECT_GE(links, 2u);
  EXPECT_EQ(far - near, 100 * links);
  EXPECT_EQ(at(200, "clocks: {noc: 2000, synchroniser_cycles: 0}\n"), near);
  EXPECT_EQ(at(200, "clocks: {noc: 2000, synchroniser_cycles: 2}\n"), near + 3 * links);
  const std::uint64_t slow = at(100, "clocks: {noc: 500, synchroniser_cycles: 1}\n");
  EXPECT_GE(slow, far + 3 * links);
  EXPECT_LE(slow, far + 4 * links);
}

// Stores, collections, contexts and caches that differ: nothing is lost, and each does something.
TEST_F(RingOfRays, ResourcesThatDifferHaveTheSameHits) {
  const std::string base =
      "memory: {l1_kib: 4, l1_ways: 4, shape_buffer_kib: 4}\ncollections: {partial: after}\nrays: {slots_per_resource: "
      "32}\npackets: {rays: 8}\n";
  const auto machine = [&](const std::string& own) {
    return base + "topology: {shape: graph, nodes: [{name: r, count: 3}, {name: q, count: 2" + own +
           "}], links: [{ring: 'r[*], q[*]'}]}\n";
  };
  const std::uint64_t plain = cycles_of(scene_, machine(""));
  for (const char* own : {"slots_per_resource: 5", "reads_per_cycle: 1", "ids_per_cycle: 1", "ready: 2",
                          "sort_ids_per_cycle: 1", "partial_after_cycles: 3", "fetch_ahead: 0", "l1_kib: 1",
                          "l1_latency_cycles: 90", "testers: {contexts: 1}", "testers: {contexts: 40, box: 1}"}) {
    SCOPED_TRACE(own);
    EXPECT_NE(cycles_of(scene_, machine(std::string(", ") + own)), plain);
  }
  for (const char* placement : {"first_taker", "addressed", "round_robin"})
    run_text(scene_, machine(", slots_per_resource: 9"), {fmt::format("rays.placement={}", placement)});
  run_text(scene_, machine(", slots_per_resource: 700"));
  run_text(scene_, machine(", slots_per_resource: 9"), {"bundles.size=4"});
}

}  // namespace
}  // namespace carousel::ringbus::ring_of_rays_test
