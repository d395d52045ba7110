// Machines that are drawn whose resources trace their own rays, with caches, memories and shading behind links.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel::drawn_stacks_test {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

const std::string kScene =
    "scene: {builtin: terrain, triangles: 600}\nimage: {width: 24, height: 16}\nengine: {kind: cycle, threads: 1, "
    "what_if: false}\nrays: {slots_per_resource: 64}\npackets: {rays: 8}\n";

/// Two clusters of four with an L2 each, a memory behind a slow link, and shading behind a router.
const std::string kClusters =
    "topology:\n  shape: graph\n  trace: stacks\n  nodes:\n    - {name: left, count: 4}\n"
    "    - {name: right, count: 4}\n    - {name: a, kind: cache, serves: 'left[*]'}\n"
    "    - {name: b, kind: cache, serves: 'right[*]'}\n    - {name: dram, kind: memory}\n"
    "    - {name: x, kind: router, latency_cycles: 1}\n    - {name: shaders, kind: shading}\n  links:\n"
    "    - {from: 'left[*]', to: a, both: true, carries: [shapes]}\n"
    "    - {from: 'right[*]', to: b, both: true, carries: [shapes]}\n"
    "    - {from: a, to: dram, both: true, carries: [shapes]}\n"
    "    - {from: b, to: dram, both: true, carries: [shapes], latency_cycles: 40, bytes_per_cycle: 4}\n"
    "    - {from: 'left[*]', to: x, both: true, carries: [new_rays, completed_rays]}\n"
    "    - {from: 'right[*]', to: x, both: true, carries: [new_rays, completed_rays]}\n"
    "    - {from: x, to: shaders, both: true, carries: [new_rays, completed_rays]}\n";

Json report_of(const Program& program, const std::string& file, const std::vector<std::string>& sets = {}) {
  std::vector<std::string> arguments{"run", file, "--json", "--force"};
  add_sets(arguments, sets);
  const Outcome run = program.run(arguments);
  EXPECT_EQ(run.status, 0) << testing::PrintToString(sets) << run.err;
  return run.status == 0 ? Json::parse(run.out) : Json::object();
}

/// The packets of the links between two nodes of the drawing, one way.
std::uint64_t messages(const Json& report, const std::string& from, const std::string& to) {
  std::uint64_t sum = 0;
  for (const Json& link : report["links"])
    if (report["drawing"][link["from"].get<std::size_t>()]["name"] == from &&
        report["drawing"][link["to"].get<std::size_t>()]["name"] == to)
      sum += link["packets"].get<std::uint64_t>();
  return sum;
}

TEST(DrawnStacks, TwoClustersWithAnL2EachFindWhatARingFinds) {
  const Program program;
  program.write("ring.yaml", kScene);
  program.write("clusters.yaml", kScene + kClusters);
  const Json ring = report_of(program, "ring.yaml");
  const std::vector<std::vector<std::string>> variants{
      {"verify=reference"},
      {"engine.threads=3"},
      {"testers.simt={warp: 8, warps: 4, stack_entries: 2}"},
      {"testers.simt={warp: 8, warps: 4, compaction: repack}"},
      {"testers.simt={warp: 8, warps: 4, prefetch: treelet, prefetch_rays: 2}", "bvh.treelets.bytes=1000"},
      {"memory.l1_kib=4", "bvh.treelets.bytes=1000"},
      {"topology.nodes.2={name: a, kind: cache, count: 3, serves: 'left[*]'}",
       "topology.links.0={from: 'left[*]', all_to: 'a[*]', both: true, carries: [shapes]}",
       "topology.links.2={from: 'a[*]', to: dram, both: true, carries: [shapes]}"}};
  for (const std::vector<std::string>& sets : variants) {
    const Json report = report_of(program, "clusters.yaml", sets);
    EXPECT_EQ(report["digest"], ring["digest"]) << testing::PrintToString(sets);
    EXPECT_EQ(report["rays"]["completed"], ring["rays"]["completed"]);
    EXPECT_FALSE(report.contains("packets") && report["packets"]["issued"] != 0);
  }
  const Json report = report_of(program, "clusters.yaml");
  EXPECT_EQ(report["engine"]["cycles"], report_of(program, "clusters.yaml", {"engine.threads=2"})["engine"]["cycles"]);
  EXPECT_GT(messages(report, "left[0]", "a"), 0u);
  EXPECT_EQ(messages(report, "x", "shaders"),
            messages(report, "left[0]", "x") + messages(report, "left[1]", "x") + messages(report, "left[2]", "x") +
                messages(report, "left[3]", "x") + messages(report, "right[0]", "x") +
                messages(report, "right[1]", "x") + messages(report, "right[2]", "x") +
                messages(report, "right[3]", "x"));
  EXPECT_LT(report_of(program, "clusters.yaml",
                      {"topology.links.3.latency_cycles=4", "topology.links.3.bytes_per_cycle=64"})["engine"]["cycles"],
            report["engine"]["cycles"]);
}

// One ray at a time waits for each of its requests, so it takes each link's latency there and back as often as it asks.
TEST(DrawnStacks, ALoneRayWaitsForTheLinksOfEachRequest) {
  const Program program;
  program.write(
      "one.yaml",
      "scene: {builtin: terrain, triangles: 600}\nimage: {width: 8, height: 4, max_depth: 1}\nengine: {kind: "
      "cycle, threads: 1, what_if: false}\nrays: {slots_per_resource: 1}\npackets: {rays: 1}\nshading: "
      "{workers: 1}\ntopology:\n  shape: graph\n  trace: stacks\n  nodes: [{name: r}, {name: l2, kind: cache}, "
      "{name: s, kind: shading}]\n  links:\n    - {from: r, to: l2, both: true, carries: [shapes]}\n"
      "    - {from: r, to: s, carries: [completed_rays]}\n    - {from: s, to: r, carries: [new_rays]}\n");
  const auto cycles = [&](const std::vector<std::string>& sets) {
    return report_of(program, "one.yaml", sets)["engine"]["cycles"].get<std::uint64_t>();
  };
  const Json base = report_of(program, "one.yaml");
  const std::uint64_t asked = messages(base, "r", "l2"), rays = base["rays"]["completed"];
  EXPECT_EQ(asked, messages(base, "l2", "r"));
  EXPECT_EQ(messages(base, "r", "s"), rays);
  EXPECT_GT(asked, 10u);
  const std::uint64_t now = base["engine"]["cycles"];
  EXPECT_EQ(cycles({"topology.links.0.latency_cycles=54"}), now + 2 * 50 * asked);
  EXPECT_EQ(cycles({"topology.links.1.latency_cycles=54"}), now + 50 * rays);
  EXPECT_EQ(cycles({"topology.links.2.latency_cycles=54"}), now + 50 * rays);
}

TEST(DrawnStacks, CheckSaysPartsAndVerdict) {
  const Program program;
  program.write("clusters.yaml", kScene + kClusters);
  const Outcome check = program.run({"check", "clusters.yaml"});
  ASSERT_EQ(check.status, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("# graph: 8 resources, 1 router, 0 links of one way\n"));
  EXPECT_THAT(check.out, HasSubstr("# parts: 2 caches, 1 memory, 1 shading, 38 links that carry no packets\n"));
  EXPECT_THAT(check.out, HasSubstr("# ways to a: 4 cycles at most, from left[0] to a\n"));
  EXPECT_THAT(check.out, HasSubstr("# deadlock: impossible. independent: every resource traces its own rays"));
  // 4 cycles of 2 ns, behind a synchroniser of two of them and before one of two of 1 ns.
  const Outcome slow = program.run({"check", "clusters.yaml", "--set", "clocks.noc=500"});
  ASSERT_EQ(slow.status, 0) << slow.err;
  EXPECT_THAT(slow.out, HasSubstr("# ways to a: 14 cycles at most, from left[0] to a\n"));
  const Outcome json = program.run({"check", "clusters.yaml", "--json"});
  ASSERT_EQ(json.status, 0) << json.err;
  EXPECT_EQ(Json::parse(json.out)["ignored_keys"], Json::array()) << json.out;
}

TEST(DrawnStacks, ADrawingIsItsOwnDrawing) {
  const Program program;
  program.write("clusters.yaml", kScene + kClusters);
  const Outcome drawn = program.run({"check", "clusters.yaml", "--graph"});
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_THAT(drawn.out, HasSubstr("  shape: graph\n  trace: stacks\n"));
  program.write("again.yaml", kScene + drawn.out);
  EXPECT_EQ(report_of(program, "again.yaml")["engine"]["cycles"],
            report_of(program, "clusters.yaml")["engine"]["cycles"]);
}

TEST(DrawnStacks, TheTwinOfADrawingIsTheDrawingWithoutPackets) {
  const Program program;
  program.write("packets.yaml", kScene + kClusters);
  const std::vector<std::string> more{
      "--no-search",
      "--set",
      "topology.trace=packets",
      "--set",
      "topology.links.4={from: 'left[*], right[*]', to: x, both: true, carries: [packets, new_rays, completed_rays]}",
      "--set",
      "topology.links.5={ring: 'left[*], right[*]'}"};
  const auto versus = [&](const std::string& file, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"versus", file});
    const Outcome outcome = program.run(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome;
  };
  std::vector<std::string> arguments = more;
  arguments.insert(arguments.end(), {"--out", "o"});
  EXPECT_THAT(versus("packets.yaml", arguments).out, HasSubstr("\nthe twin has the drawing of this machine without "
                                                               "packets; at equal area"));
  const Json json = Json::parse(program.read("o/versus.json"));
  EXPECT_THAT(json["twin_sets"].dump(), HasSubstr("topology.trace=stacks"));
  EXPECT_THAT(program.read("o/versus.html"), HasSubstr("the twin has the drawing"));
  for (const std::string& text : {program.read("o/versus.html"), json["lines"][2].get<std::string>()})
    EXPECT_THAT(text, HasSubstr("; that twin is not drawn"));
  // The twin by hand.
  const Json twin = report_of(program, "packets.yaml", {"testers.simt={warp: 32, warps: 2}"});
  EXPECT_EQ(json["runs"][json["seeds"].get<std::size_t>()]["machine"], "twin");
  EXPECT_EQ(json["runs"][json["seeds"].get<std::size_t>()]["cycles"], twin["engine"]["cycles"]);

  // Clocks stay, but for one of packets alone.
  std::vector<std::string> other = more;
  for (const std::string set : {"clocks={noc: 1500, slow: 500, ring: 300}", "topology.links.2.clock=slow",
                                "topology.links.5={ring: 'left[*], right[*]', clock: ring}"})
    other.insert(other.end(), {"--set", set});
  other.insert(other.end(), {"--out", "c"});
  EXPECT_THAT(versus("packets.yaml", other).out, HasSubstr("\nthe twin has the drawing of this machine"));
  const Json clocks = Json::parse(program.read("c/versus.json"));
  EXPECT_EQ(clocks["runs"][clocks["seeds"].get<std::size_t>()]["cycles"],
            report_of(program, "packets.yaml",
                      {"clocks={noc: 1500, slow: 500}", "topology.links.2.clock=slow",
                       "testers.simt={warp: 32, warps: 2}"})["engine"]["cycles"]);

  const Outcome processes = versus(CAROUSEL_SOURCE_DIR "/configs/packet_processes.yaml",
                                   {"--no-search", "--set", "image={width: 12, height: 8, samples: 1, max_depth: 1}",
                                    "--set", "scene.triangles=300", "--out", "p"});
  EXPECT_THAT(processes.out, HasSubstr("the twin is not drawn, and has wires of its own: the drawing of packet "
                                       "processes"));
}

TEST(DrawnStacks, TheTwinOfPacketsAloneIsNotDrawn) {
  const Program program;
  program.write("rings.yaml",
                kScene +
                    "clocks: {slow: 700}\ntopology: {shape: graph, nodes: [{name: r, count: 3}, {name: x, "
                    "kind: router, clock: slow}], links: [{ring: 'r[*], x', clock: slow}]}\n");
  const Outcome outcome = program.run({"versus", "rings.yaml", "--no-search", "--out", "o"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("has wires of its own: links of this machine carry packets alone"));
}

TEST(DrawnStacks, AMachineInWarpsHasNoTwin) {
  const Program program;
  program.write("clusters.yaml", kScene + kClusters);
  const Outcome outcome = program.run({"versus", "clusters.yaml", "--set", "testers.simt.warp=8", "--out", "o"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("clusters.yaml:8:10: topology.trace: this machine is the conventional one itself, "
                                     "with warps of 8; expected packets, or testers.simt.warp: 0; found stacks"));
}

}  // namespace
}  // namespace carousel::drawn_stacks_test
