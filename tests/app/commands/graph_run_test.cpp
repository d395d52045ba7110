// Machines on networks that are drawn. A shape that `check --graph` has drawn is the same machine to the last number.
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel::graph_run_test {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;
using testing::Not;

const std::string kMachine =
    "scene: {builtin: terrain, triangles: 600}\nimage: {width: 24, height: 16}\nengine: {kind: cycle, threads: 1}\n"
    "rays: {slots_per_resource: 64}\npackets: {rays: 8}\n";

/// All that a report says but how the machine was named, and what the host took.
Json results(const Program& program, const std::string& folder) {
  Json report = Json::parse(program.read(folder + "/report.json"));
  for (const char* key : {"config", "host", "ignored_keys", "checksum", "drawing"}) report.erase(key);
  for (auto& [key, section] : report.items())
    if (section.is_object())
      for (const char* time : {"seconds", "wall_seconds", "build_seconds", "import_seconds"}) section.erase(time);
  return report;
}

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
  for (const std::string& set : GetParam().sets) more.insert(more.end(), {"--set", set});
  for (const char* name : {"shape", "graph"}) {
    std::vector<std::string> arguments{"run", std::string(name) + ".yaml", "--out", name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome run = program.run(arguments);
    ASSERT_EQ(run.status, 0) << run.err;
  }
  EXPECT_EQ(results(program, "shape"), results(program, "graph")) << drawn.out;
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
        Drawn{"PointToPointBubble", "shape: point_to_point, resources: 3, flow: bubble"}),
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
    for (const std::string& set : sets) arguments.insert(arguments.end(), {"--set", set});
    const Outcome run = program.run(arguments);
    ASSERT_EQ(run.status, 0) << testing::PrintToString(sets) << run.err;
    EXPECT_EQ(Json::parse(run.out)["digest"], expected) << testing::PrintToString(sets);
  }
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
    for (const std::string& set : sets) arguments.insert(arguments.end(), {"--set", set});
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

TEST(GraphRun, ShapesThatAreNoGraphsAreRefused) {
  const Program program;
  program.write("bus.yaml", kMachine + "topology: {shape: bus}\n");
  const Outcome bus = program.run({"check", "bus.yaml", "--graph"});
  EXPECT_EQ(bus.status, 2);
  EXPECT_THAT(bus.err, HasSubstr("bus.yaml:6:19: topology.shape: a graph cannot say bus yet: a bus is one medium"));
  const Outcome both = program.run({"check", "bus.yaml", "--graph", "--set", "topology.shape=bidirectional"});
  ASSERT_EQ(both.status, 0) << both.err;
  EXPECT_THAT(both.out, HasSubstr("# Not the same machine: "));
}

}  // namespace
}  // namespace carousel::graph_run_test
