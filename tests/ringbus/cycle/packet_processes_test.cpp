// Packet processes that serve resources (US 9633468 with several central units): the hits of every machine, rays and
// tests at resources, collections at packet processes, and a verdict on deadlock that counts those who issue packets.
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ringbus/topology/graph_facts.h"
#include "tests/ringbus/support/timed_machine.h"

namespace carousel::ringbus::packet_processes_test {
namespace {

using testing::HasSubstr;

/// Two packet processes, each with three resources and a cache of their own.
const std::string kRays = "rays: {slots_per_resource: 32}\npackets: {rays: 8}\ncollections: {ready: 8}\n";
const std::string kNodes =
    "topology:\n  shape: graph\n  nodes:\n    - {name: r, count: 6}\n"
    "    - {name: p, kind: packet_process, count: 2, serves: 'r[*]'}\n";
const std::string kCaches =
    "    - {name: l2_a, kind: cache, serves: 'r[0..2]'}\n    - {name: l2_b, kind: cache, serves: 'r[3..5]'}\n";
const std::string kLinks =
    "  links:\n    - {from: 'r[0..2]', to: 'p[0]', both: true}\n"
    "    - {ring: 'r[3..5], p[1]'}\n";
const std::string kShapes =
    "    - {from: 'r[0..2]', to: l2_a, both: true, carries: [shapes]}\n"
    "    - {from: 'r[3..5]', to: l2_b, both: true, carries: [shapes]}\n";
const std::string kMachine = kRays + kNodes + kCaches + kLinks + kShapes;

class PacketProcesses : public testing::Test {
 protected:
  TestScene scene_{builtin_scene(BuiltinScene::kCornell, 0, 0), 400, 2};
};

TEST_F(PacketProcesses, FindTheSameHits) {
  for (const char* set :
       {"topology.tour=names", "topology.tour=nearest", "topology.flow=bubble", "topology.link.depth=1",
        "collections.traversal=ordered", "collections.traversal=treelet", "packets.shapes=single",
        "bvh.treelets.bytes=4096", "testers.own_rays=after", "testers.any_hit=shader", "rays.placement=round_robin",
        "memory.l1_kib=4", "packets.results=message", "rays.query.nearest=2", "testers.window=4"}) {
    SCOPED_TRACE(set);
    for (const std::size_t threads : {1u, 3u}) run_text(scene_, kMachine, {set}, threads);
  }
}

TEST_F(PacketProcesses, AreTheSameMachineInTheNativeEngine) {
  const std::string machine = "scene: {builtin: cornell}\nengine: {kind: native}\n" + kRays + kNodes + kLinks;
  for (const char* set : {"bundles.size=0", "bundles.size=4", "faults.resource.kind=stop"}) {
    SCOPED_TRACE(set);
    for (const std::size_t threads : {1u, 4u}) {
      Cell cell;
      cell.config =
          load_config({machine, "m.yaml"}, std::vector<std::string>{"bundles.builder.threshold=2", set}).config;
      cell.threads = threads;
      EXPECT_EQ(run_cell(scene_, cell).fault, "");
    }
  }
}

TEST_F(PacketProcesses, GoOnNativelyWhenOneStops) {
  for (const char* number : {"1", "6", "7"})
    for (const char* after : {"0", "20"}) {
      SCOPED_TRACE(number);
      SCOPED_TRACE(after);
      for (const std::size_t threads : {1u, 3u}) {
        Cell cell;
        cell.config =
            load_config(
                {"scene: {builtin: cornell}\nengine: {kind: native}\n" + kRays + kNodes + kLinks, "m.yaml"},
                std::vector<std::string>{"faults.resource.kind=stop", std::string("faults.resource.number=") + number,
                                         std::string("faults.resource.after_rays=") + after})
                .config;
        cell.threads = threads;
        const Outcome out = run_cell(scene_, cell);
        EXPECT_EQ(out.fault, "");
        if (after[0] != '0') continue;
        EXPECT_GT(out.result.rays_restarted, 0u);
        for (std::size_t r = 0; r < 6 && number[0] != '1'; ++r)
          EXPECT_EQ(out.result.resources[r].rays_completed > 0, (r < 3) == (number[0] == '7')) << r;
      }
    }
}

// A packet process and its resources belong to one pool of workers.
TEST_F(PacketProcesses, HaveAPoolOfWorkersEach) {
  const std::string pools = "    - {name: s, kind: shading, serves: 'r[0]'}\n    - {name: t, kind: shading}\n";
  const std::string links =
      "    - {from: 'r[*], p[*]', all_to: 's, t', both: true, carries: [new_rays, completed_rays]}\n";
  for (const char* set : {"bundles.size=0", "bundles.size=4", "rays.placement=round_robin"}) {
    SCOPED_TRACE(set);
    std::string machine = kMachine;
    machine.insert(machine.find("  links:"), pools);
    const Outcome out = run_text(scene_, machine + links, {"bundles.builder.threshold=2", set}, 2);
    ASSERT_EQ(out.result.cycle->pools.size(), 2u);
    for (const cycle::PoolUse& pool : out.result.cycle->pools) EXPECT_GT(pool.shaded, 0u);
  }
}

TEST_F(PacketProcesses, APauseOfOneIsFeltNatively) {
  Cell cell;
  cell.config =
      load_config({"scene: {builtin: cornell}\nengine: {kind: native, clock_mhz: 1000}\n" + kRays + kNodes + kLinks +
                       "faults: {resource: {kind: pause, number: 7, after_rays: 20, cycles: 400000000}}\n",
                   "m.yaml"})
          .config;
  cell.threads = 1;
  const Outcome out = run_cell(scene_, cell);
  EXPECT_EQ(out.fault, "");
  EXPECT_GE(out.result.wall_seconds, 0.4);
}

// Rays of a bundle live at one resource of the packet process that has its ID.
TEST_F(PacketProcesses, CollectBundles) {
  for (const char* set : {"bundles.lifetime=persistent", "bundles.lifetime=reformed", "bundles.split=builder",
                          "bundles.split=untested", "bundles.leaf=primitives", "rays.placement=round_robin"}) {
    SCOPED_TRACE(set);
    for (const std::size_t threads : {1u, 3u}) {
      const Outcome out = run_text(scene_, kMachine, {"bundles.size=4", "bundles.builder.threshold=2", set}, threads);
      std::uint64_t rays = 0, admitted = 0;
      for (const BundleCounts& at_depth : out.sum.bundles) rays += at_depth.loaded_rays;
      for (const std::size_t process : {6u, 7u}) admitted += out.result.resources[process].rays_admitted;
      EXPECT_GT(rays, 0u);
      EXPECT_LT(admitted, out.result.rays_completed);
      EXPECT_EQ(admitted, out.sum.rays_admitted);
    }
  }
}

// A resource or a packet process stops: the rays that are not back at shading begin again at the others.
TEST_F(PacketProcesses, GoOnWhenOneStops) {
  for (const char* number : {"0", "4", "6", "7"})
    for (const char* after : {"0", "20"})
      for (const char* set : {"bundles.builder.threshold=2", "collections.traversal=ordered"}) {
        SCOPED_TRACE(number);
        SCOPED_TRACE(after);
        SCOPED_TRACE(set);
        const Outcome out = run_text(
            scene_, kMachine,
            {"faults.resource.kind=stop", "faults.resource.silence_cycles=500",
             set[0] == 'b' ? "bundles.size=4" : "bundles.size=0", std::string("faults.resource.number=") + number,
             std::string("faults.resource.after_rays=") + after, set},
            after[0] == '0' ? 1 : 3);
        EXPECT_GT(out.result.rays_restarted, 0u);
      }
}

// Nobody takes over the resources of a packet process, so those of the one that has stopped at once complete no ray.
TEST_F(PacketProcesses, TheResourcesOfAStoppedOneRest) {
  const Outcome out = run_text(scene_, kMachine, {"faults.resource.kind=stop", "faults.resource.number=7"});
  for (std::size_t r = 0; r < 6; ++r) EXPECT_EQ(out.result.resources[r].rays_completed > 0, r < 3) << r;
  EXPECT_EQ(out.result.resources[7].packets_issued, 0u);
}

// A packet process begins its fault by the IDs that it has taken in, as no ray completes there.
TEST_F(PacketProcesses, CountTheRaysThatTheyTakeIn) {
  const auto taken = [&](const char* after) {
    return run_text(scene_, kMachine,
                    {"faults.resource.kind=stop", "faults.resource.number=7",
                     std::string("faults.resource.after_rays=") + after})
        .result.resources[7]
        .rays_admitted;
  };
  EXPECT_EQ(taken("0"), 0u);
  EXPECT_GE(taken("40"), 40u);
  EXPECT_LT(taken("40"), 40u + 8);  // packets have 8 rays
}

TEST_F(PacketProcesses, APauseOfOneIsFelt) {
  const auto paused = [&](const char* cycles) {
    return cycles_of(
        scene_, kMachine,
        {"faults.resource.kind=pause", "faults.resource.number=6", std::string("faults.resource.cycles=") + cycles});
  };
  EXPECT_GT(paused("20000"), paused("1") + 10'000);
}

TEST_F(PacketProcesses, KeepTheCollectionsAndNoRays) {
  const Outcome out = run_text(scene_, kMachine);
  ASSERT_EQ(out.result.resources.size(), 8u);
  for (std::size_t r = 0; r < 8; ++r) {
    SCOPED_TRACE(r);
    const ResourceStatistics& one = out.result.resources[r];
    const bool manager = r >= 6;
    EXPECT_EQ(one.packets_issued > 0, manager);
    EXPECT_EQ(one.rays_admitted > 0, manager);
    EXPECT_EQ(one.rays_completed > 0, !manager);
    EXPECT_EQ(one.local_rays > 0, !manager);
    EXPECT_EQ(out.result.collections[r].memberships_peak > 0, manager);
  }
}

// Where a cache serves them, their collections spill over its links, and come back.
TEST_F(PacketProcesses, SpillToTheCacheThatServesThem) {
  const std::string machine =
      "rays: {slots_per_resource: 64}\npackets: {rays: 8}\n" + kNodes +
      "    - {name: l2_a, kind: cache, serves: 'r[0..2]'}\n    - {name: l2_b, kind: cache, serves: 'r[3..5], p[*]'}\n" +
      kLinks + "    - {from: 'p[0..1]', to: l2_b, both: true, latency_cycles: LATENCY, carries: [shapes]}\n" + kShapes;
  const auto machine_at = [&](const std::string& latency) {
    std::string text = machine;
    text.replace(text.find("LATENCY"), 7, latency);
    return text + "collections: {when_full: spill}\n";
  };
  const auto run = [&](const std::string& latency) { return run_text(scene_, machine_at(latency)); };
  const Outcome few = run("10"), far = run("90");
  for (const char* number : {"1", "7"}) {
    const Outcome out = run_text(
        scene_, machine_at("10") + "faults: {resource: {kind: stop, after_rays: 40, number: " + number + "}}\n");
    EXPECT_GT(out.result.rays_restarted, 0u) << number;
  }
  std::uint64_t spilled = 0, over_links = 0;
  for (std::size_t r = 0; r < 8; ++r) {
    spilled += few.result.collections[r].spilled;
    EXPECT_EQ(few.result.collections[r].spilled > 0, r >= 6) << r;
  }
  EXPECT_GT(spilled, 0u);
  for (const cycle::LinkUse& link : few.result.cycle->links)
    if (link.from == 6 || link.from == 7) over_links += link.to == 9 ? link.bytes : 0;
  EXPECT_GT(over_links, 4 * spilled);  // an ID has 4 bytes, and a block a header
  EXPECT_GT(far.result.cycle->cycles, few.result.cycle->cycles);
}

// Six resources have box units, and eight read packets: the bounds and shares of classes of parts are by these.
TEST_F(PacketProcesses, CountNoUnits) {
  const Outcome out = run_text(scene_, kMachine);
  const auto parts_of = [&](std::string_view name) {
    const std::vector<cycle::ClassUse>& uses = out.result.cycle->uses;
    const auto use = std::ranges::find(uses, name, &cycle::ClassUse::name);
    return use == uses.end() ? 0 : use->parts;
  };
  EXPECT_EQ(parts_of("box_tests"), 6);
  EXPECT_EQ(parts_of("ray_reads"), 6);
  EXPECT_EQ(parts_of("dispatch"), 8);
}

// The bound of credits is that of those who issue: two with 4 packets each, where eight would be too many.
TEST_F(PacketProcesses, BoundThePacketsOnTheWay) {
  const Config config = load_config({"scene: {builtin: cornell}\nengine: {kind: cycle}\n" + kMachine, "m.yaml"},
                                    std::vector<std::string>{"topology.link.depth=4"})
                            .config;
  const DeadlockVerdict verdict = deadlock_verdict(config);
  EXPECT_FALSE(verdict.can_deadlock);
  EXPECT_THAT(verdict.rule,
              HasSubstr("credits: 2 packet processes with at most 4 packets each put 8 packets on the way"));
  const GraphFacts facts = graph_facts(config.topology);
  EXPECT_EQ(facts.ways, 2u * 4 * 4);
  EXPECT_EQ(facts.served, "packet processes: p[0] serves r[0], r[1], r[2]; p[1] serves r[3], r[4], r[5]\n");
}

TEST_F(PacketProcesses, OneIsSpokenOfAsOne) {
  const std::string one =
      "scene: {builtin: cornell}\nengine: {kind: cycle}\ntopology:\n  shape: graph\n  link: {depth: 2}\n"
      "  nodes: [{name: r, count: 3}, {name: p, kind: packet_process, serves: 'r[*]'}, {name: l2, kind: cache}]\n"
      "  links:\n    - {ring: 'r[*], p'}\n    - {from: 'r[*]', to: l2, both: true, carries: [shapes]}\n";
  EXPECT_THAT(deadlock_verdict(load_config({one, "m.yaml"}).config).rule,
              HasSubstr("credits: 1 packet process with at most 2 packets each puts 2 packets on the way"));
}

// One ray, one resource and its packet process: each packet crosses the link there and back, and nobody waits for the
// way home of a ray's last one.
TEST_F(PacketProcesses, ALinkIsPaidThereAndBack) {
  const auto run = [&](const char* latency) {
    return run_text(scene_,
                    "rays: {slots_per_resource: 1}\npackets: {rays: 1}\ncollections: {traversal: ordered}\ntopology:\n"
                    "  shape: graph\n  nodes: [{name: r}, {name: p, kind: packet_process, serves: r}, {name: l2, kind: "
                    "cache}]\n  links:\n    - {from: r, to: p, both: true, latency_cycles: " +
                        std::string(latency) + "}\n    - {from: r, to: l2, both: true, carries: [shapes]}\n");
  };
  const Outcome near = run("10"), far = run("20");
  EXPECT_EQ(near.sum.packets_issued, far.sum.packets_issued);
  const double expected =
      20.0 * static_cast<double>(far.sum.packets_issued) - 10.0 * static_cast<double>(far.result.rays_completed);
  EXPECT_NEAR(static_cast<double>(far.result.cycle->cycles - near.result.cycle->cycles), expected, 0.001 * expected);
}

}  // namespace
}  // namespace carousel::ringbus::packet_processes_test
