// Machines on networks that are drawn. A shape that `check --graph` has drawn is the same machine to the last number.
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"
#include "tests/app/support/same_machine.h"

namespace carousel::graph_run_test {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;
using testing::Not;

const std::string kMachine =
    "scene: {builtin: terrain, triangles: 600}\nimage: {width: 24, height: 16}\nengine: {kind: cycle, threads: 1}\n"
    "rays: {slots_per_resource: 64}\npackets: {rays: 8}\n";

struct Drawn {
  const char* name;
  const char* topology;
  std::vector<std::string> sets{};
};

class DrawnShape : public testing::TestWithParam<Drawn> {};

TEST_P(DrawnShape, TakesTheSameCycles) {
  const Program program;
  const std::string topology = GetParam().topology;
  program.write("shape.yaml", kMachine + "topology: {" + topology + "}\n");
  const Outcome drawn = program.run({"check", "shape.yaml", "--graph"});
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  ASSERT_THAT(drawn.out, HasSubstr("shape: graph"));
  program.write("graph.yaml", kMachine + drawn.out);
  // The search for the bottleneck tries other shapes, which a drawing has not.
  std::vector<std::string> more{"--quiet", "--set", "engine.what_if=false"};
  add_sets(more, GetParam().sets);
  for (const char* name : {"shape", "graph"}) {
    std::vector<std::string> arguments{"run", std::string(name) + ".yaml", "--out", name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome run = program.run(arguments);
    ASSERT_EQ(run.status, 0) << run.err;
  }
  EXPECT_EQ(results_of(program, "shape"), results_of(program, "graph")) << drawn.out;
}

INSTANTIATE_TEST_SUITE_P(
    All, DrawnShape,
    testing::Values(
        Drawn{"Ring", "resources: 4"}, Drawn{"RingOfOwners", "resources: 8, visit: owners"},
        Drawn{"NarrowRing", "resources: 5, visit: owners, link: {depth: 1, bytes_per_cycle: 4}"},
        Drawn{"Two", "resources: 2, visit: owners"}, Drawn{"Bubble", "resources: 4, flow: bubble, link: {depth: 2}"},
        Drawn{"Ordered", "resources: 4, visit: owners", {"collections.traversal=ordered"}},
        Drawn{"Window", "resources: 6, visit: owners", {"testers.window=4", "testers.contexts=1"}},
        Drawn{"TravellingRays", "resources: 4, visit: owners", {"rays.placement=first_taker"}},
        Drawn{"HashedHomes", "resources: 4, visit: owners", {"collections.home=hash", "collections.when_full=spill"}},
        Drawn{"FaultyLinks", "resources: 4", {"faults.links.drop=0.01"}},
        Drawn{
            "LostResource", "resources: 4, visit: owners", {"faults.resource={kind: stop, number: 1, after_rays: 20}"}},
        Drawn{"Hierarchical", "shape: hierarchical, resources: 8, groups: 2"},
        Drawn{"HierarchicalOwners", "shape: hierarchical, resources: 7, groups: 3, visit: owners"},
        Drawn{"OneGroup", "shape: hierarchical, resources: 4, groups: 1, visit: owners"},
        Drawn{"PointToPoint", "shape: point_to_point, resources: 5"},
        Drawn{"PointToPointBubble", "shape: point_to_point, resources: 3, flow: bubble"},
        Drawn{"MultiRing", "shape: multi_ring, resources: 4, rings: 3"},
        Drawn{"MultiRingOwners", "shape: multi_ring, resources: 7, rings: 2, visit: owners, link: {depth: 1}"},
        Drawn{"MultiRingBubble", "shape: multi_ring, resources: 4, rings: 2, flow: bubble, link: {depth: 2}"},
        Drawn{"MultiRingFaults", "shape: multi_ring, resources: 3, rings: 2", {"faults.links.drop=0.01"}},
        Drawn{"Bidirectional", "shape: bidirectional, resources: 5"},
        Drawn{"BidirectionalOwners", "shape: bidirectional, resources: 8, visit: owners, link: {bytes_per_cycle: 8}"},
        Drawn{"BidirectionalTwo", "shape: bidirectional, resources: 2, visit: owners"},
        Drawn{"BidirectionalRays", "shape: bidirectional, resources: 4", {"rays.placement=first_taker"}},
        Drawn{"BidirectionalWindow",
              "shape: bidirectional, resources: 6, visit: owners",
              {"testers.window=4", "testers.contexts=1", "collections.traversal=ordered"}},
        Drawn{"Bus", "shape: bus, resources: 5"},
        Drawn{"BusOwners", "shape: bus, resources: 6, visit: owners, link: {latency_cycles: 5, depth: 1}"},
        Drawn{"BusCells",
              "shape: bus, resources: 3",
              {"collections.home=hash", "collections.when_full=spill", "energy.profile=n7"}},
        Drawn{"BusFaults", "shape: bus, resources: 4", {"faults.links.drop=0.01"}},
        Drawn{"Cells", "shape: central, resources: 1", {"testers.simd.lanes=8", "testers.contexts=4"}},
        Drawn{"Distributor", "shape: central, resources: 1, form: distributor"},
        Drawn{"Stacks", "shape: independent, resources: 5", {"energy.profile=n45", "memory.shared_by=2"}},
        Drawn{"StacksThatDiffer",
              "shape: independent, resources: 3, overrides: [{resource: 1, slots_per_resource: 16, testers: {box: "
              "{units: 2}}}]"},
        Drawn{"OneStack", "shape: independent, resources: 1", {"memory.l1_kib=8", "memory.path_state=memory"}},
        Drawn{"StacksInOrder", "shape: independent, resources: 2", {"collections.order=stored"}},
        Drawn{"StacksInTreelets", "shape: independent, resources: 2", {"bvh.treelets.bytes=1000"}},
        Drawn{"StacksWithAPrefetcher", "shape: independent, resources: 4", {"prefetcher.lines=2"}},
        Drawn{"Warps", "shape: independent, resources: 3", {"testers.simt={warp: 8, warps: 2, stack_entries: 2}"}},
        Drawn{"PackedWarps", "shape: independent", {"testers.simt={warp: 8, warps: 2, compaction: repack}"}},
        Drawn{"HelpingLanes", "shape: independent", {"testers.simt={warp: 8, warps: 2, idle_lanes: help}"}},
        Drawn{"WarpsThatPrefetch",
              "shape: independent",
              {"bvh.treelets.bytes=2048", "testers.simt={warp: 8, warps: 2, prefetch: treelet, prefetch_rays: 2}"}}),
    [](const auto& one) { return one.param.name; });

const char* const kClusters =
    "topology:\n  shape: graph\n  nodes:\n    - {name: left, count: 4}\n    - {name: right, count: 4}\n"
    "    - {name: door, kind: router, count: 2, latency_cycles: 1}\n  links:\n    - {ring: 'left[*], door[0]'}\n"
    "    - {ring: 'right[*], door[1]', both: true}\n"
    "    - {from: 'door[0]', to: 'door[1]', both: true, latency_cycles: 20, bytes_per_cycle: 8, depth: 4}\n";

TEST(GraphRun, AnyGraphGivesTheSamePicture) {
  const Program program;
  program.write("ring.yaml", kMachine);
  program.write("graph.yaml", kMachine + kClusters);
  const Outcome ring = program.run({"run", "ring.yaml", "--json", "--set", "verify=reference"});
  ASSERT_EQ(ring.status, 0) << ring.err;
  const Json expected = Json::parse(ring.out)["digest"];
  const std::vector<std::vector<std::string>> variants{
      {},
      {"topology.visit=all"},
      {"topology.links.2.latency_cycles=200"},
      {"collections.traversal=ordered"},
      {"topology.nodes.2.buffers=1"},
      {"topology.nodes.2.buffers=1", "topology.nodes.2.forward=whole", "topology.link.depth=64"},
      {"rays.placement=first_taker", "engine.threads=2"},
      {"topology.links=[{mesh: [4, 2]}, {from: 'left[*]', all_to: 'door[0]', both: true}, {from: 'right[*]', "
       "all_to: 'door[1]', both: true}]"}};
  for (const std::vector<std::string>& sets : variants) {
    std::vector<std::string> arguments{"run", "graph.yaml", "--json", "--force", "--set", "verify=reference"};
    add_sets(arguments, sets);
    const Outcome run = program.run(arguments);
    ASSERT_EQ(run.status, 0) << testing::PrintToString(sets) << run.err;
    EXPECT_EQ(Json::parse(run.out)["digest"], expected) << testing::PrintToString(sets);
  }
}

TEST(GraphRun, MachinesSideBySideHaveNoLinkBetweenTheirHalves) {
  const Outcome check = Program().run({"check", CAROUSEL_SOURCE_DIR "/configs/packet_processes.yaml"});
  ASSERT_EQ(check.status, 0) << check.err;
  EXPECT_THAT(check.out, testing::HasSubstr("packet processes: unit[0] serves left[0], left[1], left[2], left[3]; "));
  EXPECT_THAT(check.out, testing::HasSubstr("halves: 0 bytes a cycle there and back, the narrowest of all cuts, as no "
                                            "link crosses it\n"));
}

// A packet process stops with bundles at it, and the other half of the machine has the same hits and picture.
TEST(GraphRun, HitsSurviveAPacketProcess) {
  const auto run = [&](const std::vector<std::string>& sets) {
    std::vector<std::string> arguments{"run",
                                       CAROUSEL_SOURCE_DIR "/configs/packet_processes.yaml",
                                       "--json",
                                       "--set",
                                       "image.width=32",
                                       "--set",
                                       "image.height=20"};
    add_sets(arguments, sets);
    const Outcome out = Program().run(arguments);
    EXPECT_EQ(out.status, 0) << out.err;
    return out.status == 0 ? Json::parse(out.out) : Json();
  };
  const Json whole = run({}), stopped = run({"bundles.size=4", "faults.resource.kind=stop", "faults.resource.number=9",
                                             "faults.resource.after_rays=100"});
  EXPECT_EQ(stopped["digest"], whole["digest"]);
  EXPECT_GT(stopped["rays"]["restarted"], 0);
}

TEST(GraphRun, ASlowLinkIsFelt) {
  const Program program;
  program.write("graph.yaml", kMachine + kClusters);
  const auto cycles = [&](const std::string& set) {
    const Outcome run = program.run({"run", "graph.yaml", "--json", "--force", "--set", set});
    EXPECT_EQ(run.status, 0) << run.err;
    return Json::parse(run.out)["engine"]["cycles"].get<std::uint64_t>();
  };
  const std::uint64_t base = cycles("topology.links.2.latency_cycles=20");
  EXPECT_GT(cycles("topology.links.2.latency_cycles=200"), base);
  EXPECT_LT(cycles("topology.links.2.bytes_per_cycle=64"), base);
  EXPECT_GT(cycles("topology.nodes.2.latency_cycles=40"), base);
}

TEST(GraphRun, AWiderLinkTakesMoreWire) {
  const Program program;
  program.write("graph.yaml", kMachine + kClusters);
  const auto bits = [&](const std::string& set) {
    const Outcome run = program.run({"run", "graph.yaml", "--json", "--force", "--set", "engine.what_if=false", "--set",
                                     "energy.profile=n7", "--set", "area.link_mm=1", "--set", set});
    EXPECT_EQ(run.status, 0) << run.err;
    return Json::parse(run.out)["area"]["parts"]["wires"]["size"].get<double>();
  };
  const double narrow = bits("topology.links.2.bytes_per_cycle=8");
  EXPECT_GT(bits("topology.links.2.bytes_per_cycle=16"), narrow);
  EXPECT_DOUBLE_EQ(bits("topology.links.2.bytes_per_cycle=24") - narrow,
                   2 * (bits("topology.links.2.bytes_per_cycle=16") - narrow));
}

TEST(GraphRun, CheckSaysWaysAndVerdict) {
  const Program program;
  program.write("graph.yaml", kMachine + kClusters);
  const Outcome check = program.run({"check", "graph.yaml"});
  ASSERT_EQ(check.status, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("# graph: 8 resources, 2 routers, 17 links of one way\n"));
  EXPECT_THAT(check.out, HasSubstr("# busiest: door["));
  EXPECT_THAT(check.out, HasSubstr("# deadlock: impossible. room: a circle of links holds"));
}

TEST(GraphRun, TrafficThatCanStopNeedsForce) {
  const Program program;
  program.write(
      "graph.yaml",
      "engine: {kind: cycle}\ntopology:\n  shape: graph\n  nodes: [{name: r, count: 8}]\n  links:\n    - {ring: "
      "'r[*]', depth: 1}\nworkload: {traffic: {rate: 0.9, packets: 20000}}\n");
  const Outcome refused = program.run({"run", "graph.yaml"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err,
              HasSubstr("graph.yaml:6:5: topology.links: a circle of 8 links wait for one another when they "
                        "are full (r[0] > r[1], "));
  const Outcome stuck = program.run({"run", "graph.yaml", "--force"});
  EXPECT_NE(stuck.status, 0);
  EXPECT_THAT(stuck.err, HasSubstr("nothing moves any more"));
  EXPECT_THAT(stuck.err, Not(HasSubstr("ignores")));
}

TEST(GraphRun, TrafficOnAHierarchicalNetworkIsThatOfItsDrawing) {
  const Program program;
  const std::string traffic = "engine: {kind: cycle}\nworkload: {traffic: {rate: 0.05, packets: 3000}}\n";
  program.write("lines.yaml", traffic + "topology: {shape: hierarchical, resources: 8, groups: 2, link: {depth: 4}}\n");
  const Outcome refused = program.run({"run", "lines.yaml"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("lines.yaml:3:19: topology.shape: a circle of "));
  const std::vector<std::string> channels{"--set", "topology.link.virtual_channels=4", "--set",
                                          "topology.channels=dateline"};
  const auto with_channels = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), channels.begin(), channels.end());
    return program.run(arguments);
  };
  const Outcome drawn = with_channels({"check", "lines.yaml", "--graph"});
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  program.write("drawn.yaml", traffic + drawn.out);
  const Outcome lines = with_channels({"run", "lines.yaml", "--json"}),
                same = program.run({"run", "drawn.yaml", "--json"});
  ASSERT_EQ(lines.status, 0) << lines.err;
  ASSERT_EQ(same.status, 0) << same.err;
  const Json one = Json::parse(lines.out), two = Json::parse(same.out);
  EXPECT_EQ(one["traffic"], two["traffic"]);
  EXPECT_EQ(one["links"], two["links"]);
  EXPECT_EQ(one["traffic"]["delivered"], 3000);
}

TEST(GraphRun, WaysAndToursKeepThePictureAndChangeTheTime) {
  const Program program;
  program.write("graph.yaml", kMachine + kClusters);
  std::set<std::uint64_t> cycles;
  std::set<std::string> digests;
  for (const std::vector<std::string>& sets : {std::vector<std::string>{},
                                               {"topology.tour=nearest"},
                                               {"topology.links.0.both=true", "topology.routes=up_down"},
                                               {"topology.nodes.2.credit_cycles=9"}}) {
    std::vector<std::string> arguments{"run", "graph.yaml", "--json", "--force", "--set", "verify=reference"};
    add_sets(arguments, sets);
    const Outcome run = program.run(arguments);
    ASSERT_EQ(run.status, 0) << testing::PrintToString(sets) << run.err;
    const Json report = Json::parse(run.out);
    cycles.insert(report["engine"]["cycles"].get<std::uint64_t>());
    digests.insert(report["digest"].dump());
    EXPECT_EQ(report["drawing"][8]["name"], "door[0]");
  }
  EXPECT_EQ(digests.size(), 1u);
  EXPECT_GT(cycles.size(), 1u);
}

TEST(GraphRun, APacketKeepsItsLane) {
  const Program program;
  program.write("lanes.yaml", kMachine +
                                  "topology:\n  shape: graph\n  nodes: [{name: r, count: 4}]\n  links:\n"
                                  "    - {ring: 'r[*]', lane: 0}\n    - {ring: 'r[3..0]', lane: 1}\n");
  const auto links = [&](const std::string& set) {
    const Outcome run = program.run({"run", "lanes.yaml", "--json", "--force", "--set", set});
    EXPECT_EQ(run.status, 0) << run.err;
    return Json::parse(run.out)["links"];
  };
  // By names the second lane's packets visit resources against their ring, and pass most of it.
  const auto packets = [&](const Json& rows, std::size_t lane) {
    std::uint64_t sum = 0;
    for (std::size_t i = 4 * lane; i < 4 * lane + 4; ++i) sum += rows[i]["packets"].get<std::uint64_t>();
    return sum;
  };
  const Json names = links("topology.tour=names"), nearest = links("topology.tour=nearest");
  ASSERT_EQ(names.size(), 8u);
  EXPECT_EQ(names[4]["from"], 3);
  EXPECT_EQ(names[4]["to"], 2);
  EXPECT_GT(packets(names, 1), packets(names, 0));
  EXPECT_LT(packets(nearest, 1), packets(names, 1));
}

TEST(GraphRun, CheckSaysWhatLanesAndABusCarry) {
  const Program program;
  const auto check = [&](const std::string& topology) {
    program.write("graph.yaml", kMachine + "topology:\n  shape: graph\n  nodes: " + topology);
    const Outcome outcome = program.run({"check", "graph.yaml"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.out;
  };
  const std::string lanes = check("[{name: r, count: 4}]\n  links: [{ring: 'r[*]', lanes: 2}]\n");
  EXPECT_THAT(lanes, HasSubstr("# busiest: r[0] > r[1], on 6 of 32 ways; a uniform load fills it at 1.3333 flits"));
  EXPECT_THAT(lanes, HasSubstr("# deadlock: impossible. credits: 4 resources with at most 16 packets each put 64 "));
  // Packets of both lanes may fill the link between two routers.
  const std::string meet = check(
      "[{name: r, count: 4}, {name: x, kind: router, count: 2, buffers: 1}]\n  links: [{ring: 'r[*], x[0]', lane: 0}, "
      "{ring: "
      "'r[*], x[1]', lane: 1}, {line: 'x[*]', both: true}]\n");
  EXPECT_THAT(meet, HasSubstr("4 resources put up to 32 each on the way"));
  const std::string bus = check(
      "[{name: r, count: 4}, {name: b, kind: bus}]\n  links: [{from: 'r[*]', to: b, both: "
      "true}]\n");
  EXPECT_THAT(bus, HasSubstr("# graph: 4 resources, a bus, 8 links of one way\n"));
  EXPECT_THAT(bus, HasSubstr("# busiest: b, on 12 of 16 ways; a uniform load fills it at 0.3333 flits"));
  EXPECT_THAT(bus, HasSubstr("# deadlock: impossible. bus: "));
}

TEST(GraphRun, SeveralUnitsOfACentralMachineHaveCellsAndMemoryOfTheirOwn) {
  const Program program;
  program.write("one.yaml", kMachine + "topology: {shape: central, resources: 1}\ntesters: {simd: {lanes: 8}}\n");
  program.write("units.yaml",
                kMachine +
                    "topology:\n  shape: graph\n  nodes:\n"
                    "    - {name: unit, kind: packet_process, count: 3}\n"
                    "    - {name: l2, kind: cache, count: 2}\n    - {name: dram, kind: memory}\n  links:\n"
                    "    - {ring: 'unit[*]'}\n"
                    "    - {from: 'unit[*]', all_to: 'l2[*]', both: true, carries: [shapes]}\n"
                    "    - {from: 'l2[*]', to: dram, both: true, carries: [shapes]}\n"
                    "testers: {simd: {lanes: 8}}\n");
  const auto run = [&](const std::string& file, const std::string& set) {
    const Outcome outcome = program.run({"run", file, "--json", "--force", "--set", "verify=reference", "--set", set});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return Json::parse(outcome.out);
  };
  const Json one = run("one.yaml", "engine.what_if=false"), units = run("units.yaml", "engine.what_if=false");
  EXPECT_EQ(units["digest"], one["digest"]);
  EXPECT_GT(units["links"][0]["packets"], 0);
  EXPECT_LT(units["engine"]["cycles"], one["engine"]["cycles"]);
  const std::string fewer = "topology.overrides=[{nodes: 'unit[1..2]', testers: {simd: {lanes: 1}}}]";
  EXPECT_GT(run("units.yaml", fewer)["engine"]["cycles"], units["engine"]["cycles"]);
}

}  // namespace
}  // namespace carousel::graph_run_test
