// Networks that are drawn: what is read, what is refused and where, and that what is written reads back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/graph/drawn_parts.h"
#include "core/config/graph/graph.h"
#include "core/config/own_sections.h"
#include "core/config/write.h"
#include "tests/core/config/bad_config.h"

namespace carousel::graph_config_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kHead = "scene: {builtin: cornell}\nengine: {kind: cycle}\n";

Config read(const std::string& topology) {
  return parse_config(kHead + topology, "test.yaml");
}

/// The links by the names of their nodes.
std::vector<std::string> links_of(const Config& config) {
  std::vector<config::GraphIssue> issues;
  const config::Graph graph = config::draw_graph(config.topology, issues);
  EXPECT_TRUE(issues.empty()) << issues.front().message;
  std::vector<std::string> out;
  for (const config::Graph::Link& link : graph.links) out.push_back(graph.name_of(link));
  return out;
}

TEST(GraphConfig, PatternsAreWrittenOutInOrder) {
  const auto links = [](const std::string& list) {
    return links_of(
        read("topology:\n  shape: graph\n  nodes: [{name: r, count: 4}, {name: hub, kind: router}]\n  links: [" + list +
             "]\n"));
  };
  EXPECT_THAT(links("{ring: 'r[*]'}, {from: 'r[0]', to: hub, both: true}"),
              ElementsAre("r[0] > r[1]", "r[1] > r[2]", "r[2] > r[3]", "r[3] > r[0]", "r[0] > hub", "hub > r[0]"));
  EXPECT_THAT(links("{ring: 'hub, r[0..3]'}"),
              ElementsAre("hub > r[0]", "r[0] > r[1]", "r[1] > r[2]", "r[2] > r[3]", "r[3] > hub"));
  EXPECT_THAT(links("{from: 'r[*]', to: hub, both: true}"),
              ElementsAre("r[0] > hub", "hub > r[0]", "r[1] > hub", "hub > r[1]", "r[2] > hub", "hub > r[2]",
                          "r[3] > hub", "hub > r[3]"));
  EXPECT_THAT(links("{from: 'r[0..1]', to: 'r[2..3]', both: true}, {from: 'r[2]', to: hub, both: true}, "
                    "{line: 'r[0], hub, r[3]', both: true}"),
              ElementsAre("r[0] > r[2]", "r[2] > r[0]", "r[1] > r[3]", "r[3] > r[1]", "r[2] > hub", "hub > r[2]",
                          "r[0] > hub", "hub > r[0]", "hub > r[3]", "r[3] > hub"));
  EXPECT_THAT(links("{ring: 'r[2..0], hub', lanes: 2}, {from: 'r[0]', to: 'r[3]', both: true}"),
              ElementsAre("r[2] > r[1]", "r[1] > r[0]", "r[0] > hub", "hub > r[2]", "r[2] > r[1]", "r[1] > r[0]",
                          "r[0] > hub", "hub > r[2]", "r[0] > r[3]", "r[3] > r[0]"));
  EXPECT_THAT(links("{mesh: [2, 2]}, {from: 'r[*]', all_to: hub, both: true}").size(), 16u);
  EXPECT_THAT(links("{from: 'r[0..2]', all_to: 'r[0..2]'}, {line: 'r[2], r[3], hub', both: true}"),
              ElementsAre("r[0] > r[1]", "r[0] > r[2]", "r[1] > r[0]", "r[1] > r[2]", "r[2] > r[0]", "r[2] > r[1]",
                          "r[2] > r[3]", "r[3] > r[2]", "r[3] > hub", "hub > r[3]"));
}

TEST(GraphConfig, AMeshHasItsNeighboursRowByRow) {
  EXPECT_THAT(links_of(read("topology: {shape: graph, nodes: [{name: r, count: 6}], links: [{mesh: [3, 2]}]}\n")),
              ElementsAre("r[0] > r[1]", "r[1] > r[0]", "r[0] > r[3]", "r[3] > r[0]", "r[1] > r[2]", "r[2] > r[1]",
                          "r[1] > r[4]", "r[4] > r[1]", "r[2] > r[5]", "r[5] > r[2]", "r[3] > r[4]", "r[4] > r[3]",
                          "r[4] > r[5]", "r[5] > r[4]"));
}

TEST(GraphConfig, WhatALinkDoesNotSayIsThatOfAllLinks) {
  const Config config = read(
      "topology:\n  shape: graph\n  link: {latency_cycles: 7, depth: 3}\n  nodes: [{name: a}, {name: b}]\n"
      "  links: [{from: a, to: b}, {from: b, to: a, latency_cycles: 2, depth: 5, bytes_per_cycle: 8}]\n");
  EXPECT_EQ(config.topology.resources, 2);
  EXPECT_EQ(config.topology.visit, Visit::kOwners);
  std::vector<config::GraphIssue> issues;
  const config::Graph graph = config::draw_graph(config.topology, issues);
  ASSERT_EQ(graph.links.size(), 2u);
  EXPECT_EQ(graph.links[0].latency_cycles, 7);
  EXPECT_EQ(graph.links[0].depth, 3);
  EXPECT_EQ(graph.links[0].bytes_per_cycle, 32);
  EXPECT_EQ(graph.links[1].latency_cycles, 2);
  EXPECT_EQ(graph.links[1].depth, 5);
  EXPECT_EQ(graph.links[1].bytes_per_cycle, 8);
}

TEST(GraphConfig, ReadsBackAsItIsWritten) {
  const Config config = read(
      "topology:\n  shape: graph\n  nodes:\n    - {name: r, count: 4, latency_cycles: 2}\n"
      "    - {name: hub, kind: router, buffers: 4, forward: whole}\n  links:\n    - {ring: 'r[*]', both: true, depth: "
      "2}\n"
      "    - {from: 'r[0]', to: hub, both: true, bytes_per_cycle: 8}\n    - {mesh: [2, 1], of: 'r[0], r[2]'}\n");
  const std::string text = resolved_yaml(config);
  const Config again = parse_config(text, "again.yaml");
  EXPECT_EQ(again.topology.nodes, config.topology.nodes) << text;
  EXPECT_EQ(again.topology.links, config.topology.links) << text;
  EXPECT_EQ(resolved_yaml(again), text);
}

class BadGraph : public testing::TestWithParam<BadConfig> {};

TEST_P(BadGraph, IsRefusedByName) {
  EXPECT_THAT(texts(issues_of(kHead + GetParam().text)), ElementsAre(HasSubstr(GetParam().message)));
}

INSTANTIATE_TEST_SUITE_P(
    All, BadGraph,
    testing::Values(
        BadConfig{"UnknownNode",
                  "topology:\n  shape: graph\n  nodes: [{name: ring, count: 3}]\n  links:\n    - {ring: 'ring[*]'}\n"
                  "    - {from: 'rign[0]', to: 'ring[2]'}\n",
                  "test.yaml:8:14: topology.links.1.from: expected a node, found 'rign'; did you mean 'ring[*]'?"},
        BadConfig{
            "BeyondTheGroup",
            "topology:\n  shape: graph\n  nodes: [{name: r, count: 3}]\n  links: [{ring: 'r[*]'}, {from: 'r[3]', to: "
            "'r[0]'}]\n",
            "test.yaml:6:34: topology.links.1.from: expected r[*], or r[i] or r[i..j] with numbers from 0 to 2, "
            "found 'r[3]'"},
        BadConfig{"GroupWithoutBrackets",
                  "topology: {shape: graph, nodes: [{name: r, count: 3}], links: [{ring: r}]}\n",
                  "r is a group of 3; expected r[*], r[0] or r[0..2], found 'r'"},
        BadConfig{"BusOfAnotherClock",
                  "clocks: {noc: 300}\ntopology: {shape: graph, nodes: [{name: r, count: 2}, {name: b, kind: bus}],\n  "
                  "links: [{from: 'r[*]', to: b, both: true}]}\n",
                  "topology.links.0.clock: a bus moves its packets one after the other by the clock of the resources; "
                  "expected core, found noc"},
        BadConfig{
            "TreeletsOnABus",
            "bvh: {treelets: {bytes: 4096}}\ntopology: {shape: graph, nodes: [{name: r, count: 2}, {name: b, kind: "
            "bus}],\n  links: [{from: 'r[*]', to: b, both: true}]}\n",
            "topology.nodes: the rays of a treelet are tested one by one and leave it for different places, which "
            "an answer on a bus does not carry; expected a ring or another network, found bus"},
        BadConfig{
            "TreeletsOfAPacketProcess",
            "bvh: {treelets: {bytes: 4096}}\n"
            "topology: {shape: graph, nodes: [{name: c, kind: packet_process}], links: []}\n",
            "topology.nodes: the rays of a treelet are tested one by one and leave it for different places, which "
            "a central unit does not carry; expected a ring or another network, found packet_process"},
        BadConfig{"NoWay", "topology: {shape: graph, nodes: [{name: a}, {name: b}], links: [{from: a, to: b}]}\n",
                  "topology.links: there is no way from b to a"},
        BadConfig{"TwoLinks",
                  "topology: {shape: graph, nodes: [{name: r, count: 3}], links: [{ring: 'r[*]'}, {from: 'r[1]', to: "
                  "'r[2]', carries: [packets, shapes]}]}\n",
                  "topology.links.1: a second link from r[1] to r[2], beside that of topology.links.0"},
        BadConfig{
            "ToItself",
            "topology: {shape: graph, nodes: [{name: a}, {name: b}], links: [{line: 'a, b', both: true}, {from: a, "
            "to: a}]}\n",
            "a link leads from a to a"},
        BadConfig{"NoLink",
                  "topology: {shape: graph, nodes: [{name: a}, {name: b}, {name: c}], links: [{line: 'a, b', both: "
                  "true}]}\n",
                  "topology.nodes.2: c has no link"},
        BadConfig{"RouterWithoutAWayOut",
                  "topology: {shape: graph, nodes: [{name: r, count: 3}, {name: x, kind: router}],\n"
                  "  links: [{ring: 'r[*]'}, {from: 'r[0]', to: x}]}\n",
                  "test.yaml:3:55: topology.nodes.1: x has no link from it; expected one to it and one from it"},
        BadConfig{"RingThatMeetsItself",
                  "topology: {shape: graph, nodes: [{name: r, count: 4}], links: [{ring: 'r[0..2], r[0], r[3]'}]}\n",
                  "test.yaml:3:71: topology.links.0.ring: expected each node once, found r[0] twice"},
        BadConfig{"NoNodesOfALink", "topology: {shape: graph, nodes: [{name: r, count: 2}], links: [{depth: 4}]}\n",
                  "topology.links.0: expected one of from and to, from and all_to, ring, line or mesh, found none"},
        BadConfig{"TwoWaysToSayIt",
                  "topology: {shape: graph, nodes: [{name: r, count: 2}], links: [{ring: 'r[*]', mesh: [2, 1]}]}\n",
                  "expected one of from and to, from and all_to, ring, line or mesh, found ring and mesh"},
        BadConfig{"OneWithoutAPlace",
                  "topology: {shape: graph, nodes: [{name: r, count: 2, at: [0, 0], step: [1, 0]}, {name: a}],\n"
                  "  links: [{ring: 'r[*], a'}]}\n",
                  "test.yaml:3:81: topology.nodes.1: other nodes have places, and a has none; expected `at` at all "
                  "nodes, or at none"},
        BadConfig{"PlaceOfOneNumber",
                  "topology: {shape: graph, nodes: [{name: a, at: [0]}, {name: b}], links: [{ring: 'a, b'}]}\n",
                  "topology.nodes.0.at: expected a list of two numbers, x and y"},
        BadConfig{"NamesOfNodesThatCannotBeRead",
                  "topology: {shape: graph, nodes: [{name: r, count: 0}], links: [{ring: 'r[*]'}]}\n",
                  "test.yaml:3:51: topology.nodes.0.count: expected auto or an integer from 1 to 256 (nodes), found 0"},
        BadConfig{"TwoNames", "topology: {shape: graph, nodes: [{name: a}, {name: a}], links: []}\n",
                  "topology.nodes.1.name: there is a node or group 'a' already"},
        BadConfig{"NoName", "topology: {shape: graph, nodes: [{count: 2}], links: []}\n",
                  "topology.nodes.0: expected the key 'name'"},
        BadConfig{"BadName", "topology: {shape: graph, nodes: [{name: 'r-1'}], links: []}\n",
                  "topology.nodes.0.name: expected a letter or _ and then letters, digits and _, found 'r-1'"},
        BadConfig{"NoNodes", "topology: {shape: graph}\n", "topology.nodes: expected a resource at least"},
        BadConfig{"BubbleInALinkOfOnePlace",
                  "topology: {shape: graph, flow: bubble, nodes: [{name: r, count: 3}],\n"
                  "  links: [{ring: 'r[*]', depth: 4}, {from: 'r[0]', to: 'r[2]', depth: 1}]}\n",
                  "topology.links.1.depth: flow: bubble keeps one place of a link free; expected at least 2 for r[0] > "
                  "r[2], found 1"},
        BadConfig{"OtherUnits",
                  "topology: {shape: graph, nodes: [{name: c, kind: packet_process}, {name: a}], links: [{ring: 'a, "
                  "c'}]}\ntesters: {simd: {lanes: 8}}\n",
                  "topology.nodes.1.kind: beside a packet_process with cells of its own all nodes that own rays are "
                  "such units"},
        BadConfig{"TwoDistributors",
                  "topology: {shape: graph, form: distributor, nodes: [{name: c, kind: packet_process, count: 2}],\n"
                  "  links: [{ring: 'c[*]'}]}\n",
                  "topology.form: a distributor stands in a machine of one unit yet"},
        BadConfig{"SameLane",
                  "topology: {shape: graph, nodes: [{name: r, count: 3}], links: [{ring: 'r[*]', lanes: 2},\n"
                  "  {from: 'r[0]', to: 'r[1]', lane: 1}]}\n",
                  "test.yaml:4:3: topology.links.1: a second link from r[0] to r[1], beside that of topology.links.0"},
        BadConfig{"LaneBesideAll",
                  "topology: {shape: graph, nodes: [{name: r, count: 3}], links: [{ring: 'r[*]'}, {from: 'r[0]', to: "
                  "'r[1]', lane: 0}]}\n",
                  "topology.links.1: a second link from r[0] to r[1]"},
        BadConfig{"LaneWithoutAWay",
                  "topology: {shape: graph, nodes: [{name: r, count: 3}], links: [{ring: 'r[*]', lane: 0}, {line: "
                  "'r[*]', lane: 1}]}\n",
                  "topology.links: there is no way in lane 1 from r[1] to r[0]"},
        BadConfig{
            "TooManyLanes",
            "topology: {shape: graph, nodes: [{name: r, count: 2}], links: [{ring: 'r[*]', lane: 60, lanes: 5}]}\n",
            "topology.links.0.lanes: expected lanes up to 63 at most, found 60 to 64"},
        BadConfig{"LaneOfChannels",
                  "topology: {shape: graph, nodes: [{name: r, count: 3}], links: [{ring: 'r[*]', lanes: 2}]}\n"
                  "workload: {traffic: {}}\n",
                  "test.yaml:3:86: topology.links.0.lanes: synthetic packets have virtual channels and no lanes, or "
                  "lanes and no channels; expected 1, or topology.channels: none"},
        BadConfig{"WithoutChannelsNoRing",
                  "topology: {shape: graph, channels: none, nodes: [{name: r, count: 3}], links: [{line: 'r[*]', both: "
                  "true}]}\nworkload: {traffic: {}}\n",
                  "test.yaml:3:36: topology.channels: without virtual channels a packet keeps its lane, so the links "
                  "of each lane are one ring through all resources, or a link leads from each resource to every other"},
        BadConfig{"WithoutChannelsARouter",
                  "topology: {shape: graph, channels: none, nodes: [{name: r, count: 3}, {name: x, kind: router}],\n"
                  "  links: [{ring: 'r[*], x'}]}\nworkload: {traffic: {}}\n",
                  "test.yaml:3:87: topology.nodes.1.kind: without virtual channels packets go round rings of "
                  "resources; expected resource, or another topology.channels; found router"},
        BadConfig{"WithoutChannelsALinkOfItsOwn",
                  "topology: {shape: graph, channels: none, nodes: [{name: r, count: 3}],\n"
                  "  links: [{ring: 'r[*]', latency_cycles: 9}]}\nworkload: {traffic: {}}\n",
                  "test.yaml:4:42: topology.links.0.latency_cycles: without virtual channels all links are as "
                  "topology.link says; expected 4, found 9"},
        BadConfig{"WithoutChannelsAClock",
                  "clocks: {noc: 300}\ntopology: {shape: graph, channels: none, nodes: [{name: r, count: 3}],\n"
                  "  links: [{ring: 'r[*]'}]}\nworkload: {traffic: {}}\n",
                  "test.yaml:4:36: topology.channels: without virtual channels packets go by the clock of the "
                  "resources"},
        BadConfig{"BridgesWithoutChannels",
                  "topology: {shape: hierarchical, channels: none}\nworkload: {traffic: {}}\n",
                  "test.yaml:3:43: topology.channels: packets change from line to line at the bridges"},
        BadConfig{"LaneOfShapes",
                  "topology: {shape: graph, nodes: [{name: r, count: 2}, {name: a, kind: cache}],\n"
                  "  links: [{ring: 'r[*]'}, {from: 'r[*]', to: a, both: true, lane: 0, carries: [shapes]}]}\n",
                  "topology.links.1.lane: packets have lanes, and other messages none"},
        BadConfig{"BusWithAShortCut",
                  "topology: {shape: graph, nodes: [{name: r, count: 3}, {name: b, kind: bus}],\n"
                  "  links: [{from: 'r[*]', to: b, both: true}, {from: 'r[0]', to: 'r[1]'}]}\n",
                  "test.yaml:4:46: topology.links.1: the bus b moves packets from resources to resources"},
        BadConfig{"BusThatOneCannotHear",
                  "topology: {shape: graph, nodes: [{name: r, count: 2}, {name: b, kind: bus}],\n"
                  "  links: [{from: 'r[*]', to: b}, {from: b, to: 'r[0]'}]}\n",
                  "topology.links: expected a link from r[1] to the bus b and one back, found 1 and 0"},
        BadConfig{
            "BusAndRouter",
            "topology: {shape: graph, nodes: [{name: r, count: 2}, {name: b, kind: bus}, {name: x, kind: router}],\n"
            "  links: [{from: 'r[*]', to: b, both: true}, {line: 'r[0], x', both: true}]}\n",
            "topology.nodes.2.kind: all packets cross the bus b; expected no router and no other bus, found x"},
        BadConfig{"NarrowWayToABus",
                  "topology: {shape: graph, nodes: [{name: r, count: 2}, {name: b, kind: bus}],\n"
                  "  links: [{from: 'r[*]', to: b, both: true, bytes_per_cycle: 8}]}\n",
                  "topology.links.0.bytes_per_cycle: a bus is as wide for all"},
        BadConfig{"BuffersOfABus",
                  "topology: {shape: graph, nodes: [{name: r, count: 2}, {name: b, kind: bus, buffers: 2}],\n"
                  "  links: [{from: 'r[*]', to: b, both: true}]}\n",
                  "topology.nodes.1.buffers: packets wait for a bus at the resources"},
        BadConfig{"UnknownKind", "topology: {shape: graph, nodes: [{name: a, kind: ruoter}], links: []}\n",
                  "did you mean 'router'?"},
        BadConfig{"OtherNumber",
                  "topology: {shape: graph, resources: 8, nodes: [{name: r, count: 2}], links: [{ring: 'r[*]'}]}\n",
                  "topology.resources: the graph has 2 resources; expected 2, or no number, found 8"},
        BadConfig{"TwoPatterns",
                  "topology: {shape: graph, nodes: [{name: r, count: 2}], links: [{ring: 'r[*]', line: 'r[*]'}]}\n",
                  "topology.links.0: expected one of from and to, from and all_to, ring, line or mesh"},
        BadConfig{"MeshOfAnotherSize",
                  "topology: {shape: graph, nodes: [{name: r, count: 6}], links: [{mesh: [2, 2]}]}\n",
                  "topology.links.0.mesh: expected as many places as the graph has nodes, 6, found 2 x 2 = 4"},
        BadConfig{
            "UnequalSides",
            "topology: {shape: graph, nodes: [{name: r, count: 5}], links: [{ring: 'r[*]'}, {from: 'r[0..1]', to: "
            "'r[2..4]'}]}\n",
            "r[0..1] has 2 nodes and r[2..4] has 3"},
        BadConfig{"BuffersOfAResource",
                  "topology: {shape: graph, nodes: [{name: r, count: 2, buffers: 2}], links: [{ring: 'r[*]'}]}\n",
                  "topology.nodes.0.buffers: a resource has places for its packets in test, and other nodes this key"}),
    [](const auto& one) { return one.param.name; });

/// Two resources on a link, and beside them a cache and a memory, with these links.
std::string with_cache(const std::string& links, const std::string& cache = "") {
  return "topology:\n  shape: graph\n  nodes:\n    - {name: r, count: 2}\n    - {name: l2, kind: cache" + cache +
         "}\n    - {name: dram, kind: memory}\n  links:\n    - {ring: 'r[*]'}\n" + links;
}
const std::string kToCache = "    - {from: 'r[*]', to: l2, both: true, carries: [shapes]}\n";
const std::string kToMemory = "    - {from: l2, to: dram, both: true, carries: [shapes]}\n";

TEST(GraphConfig, PartsAreFoundBehindTheResources) {
  const Config config = read(with_cache(kToCache + kToMemory, ", serves: 'r[*]', interleave_bytes: 128"));
  std::vector<config::GraphIssue> issues;
  const config::Graph graph = config::draw_graph(config.topology, issues);
  const config::DrawnParts parts = config::find_parts(config.topology, graph, config.memory.line_bytes, issues);
  EXPECT_TRUE(issues.empty()) << issues.front().message;
  ASSERT_EQ(parts.caches.size(), 1u);
  EXPECT_THAT(parts.caches[0].nodes, ElementsAre(2u));
  EXPECT_EQ(parts.caches[0].interleave_bytes, 128);
  EXPECT_THAT(parts.caches_of, ElementsAre(0u, 0u));
  EXPECT_THAT(parts.memories.nodes, ElementsAre(3u));
  EXPECT_EQ(parts.memories.interleave_bytes, 64);
  EXPECT_TRUE(parts.pools.empty());
  const std::string text = resolved_yaml(config);
  EXPECT_EQ(parse_config(text, "again.yaml").topology.links, config.topology.links) << text;
}

TEST(GraphConfig, AnOverrideNamesNodes) {
  const Config config = read(
      "topology:\n  shape: graph\n  nodes: [{name: a, count: 2}, {name: b, count: 2}]\n  links: [{ring: 'a[*], "
      "b[*]'}]\n"
      "  overrides: [{nodes: 'b[*]', testers: {box: {units: 3}}}, {resource: 0, testers: {box: {units: 5}}}]\n");
  const auto units = [&](std::int64_t resource) {
    return own_sections(config, resource).testers.units[UnitKind::kBox].units;
  };
  EXPECT_EQ(units(0), 5);
  EXPECT_EQ(units(1), config.testers.units[UnitKind::kBox].units);
  EXPECT_EQ(units(2), 3);
  EXPECT_EQ(units(3), 3);
  const std::string text = resolved_yaml(config);
  const Config again = parse_config(text, "again.yaml");
  EXPECT_EQ(again.topology.overrides[0].named, config.topology.overrides[0].named) << text;
}

struct BadPart {
  std::string text, message;
};

TEST(GraphConfig, PartsThatCannotWorkAreRefusedByName) {
  for (const BadPart& bad : {

           BadPart{with_cache("    - {from: 'r[0]', to: l2, both: true, carries: [shapes]}\n" + kToMemory),
                   "test.yaml:10:5: topology.links: there is no way from r[1] to l2 over links that carry shapes"},
           BadPart{with_cache("    - {from: 'r[*]', to: l2, carries: [shapes]}\n" + kToMemory),
                   "topology.links: there is no way from l2 to r[0] over links that carry shapes"},
           BadPart{with_cache(kToCache + "    - {from: l2, to: dram, both: true}\n"),
                   "topology.links: there is no way from l2 to dram over links that carry shapes; expected links with "
                   "carries: [shapes] that lead there"},
           BadPart{with_cache(kToCache + kToMemory, ", serves: 'r[0]'"),
                   "topology.nodes: r[1] has no memory: no cache serves it"},
           BadPart{with_cache(kToCache + kToMemory, ", serves: 'q[0]'"),
                   "test.yaml:7:39: topology.nodes.1.serves: expected a node, found 'q'"},
           BadPart{with_cache(kToCache + kToMemory, ", serves: l2"),
                   "topology.nodes.1.serves: expected resources, found l2"},
           BadPart{with_cache(kToCache + kToMemory, ", interleave_bytes: 96"),
                   "topology.nodes.1.interleave_bytes: a node holds whole lines; expected a multiple of "
                   "memory.line_bytes = 64, found 96"},
           BadPart{"topology: {shape: graph, nodes: [{name: r}, {name: a, kind: cache}, {name: b, kind: cache}],\n"
                   "  links: [{from: r, all_to: 'a, b', both: true, carries: [shapes]}]}\n",
                   "topology.nodes.2.name: r asks a already; expected one group of caches for each resource"},
           BadPart{"topology: {shape: graph, nodes: [{name: r}, {name: dram, kind: memory}],\n"
                   "  links: [{from: r, to: dram, both: true}]}\n",
                   "topology.nodes.1.kind: a memory answers caches"},
           BadPart{"topology: {shape: graph, nodes: [{name: r, count: 2}], links: [{ring: 'r[*]'}],\n"
                   "  overrides: [{nodes: 'q[0]', testers: {box: 2}}]}\n",
                   "test.yaml:4:23: topology.overrides.0.nodes: expected a node, found 'q'"},
           BadPart{"topology: {shape: graph, nodes: [{name: r, count: 2}, {name: x, kind: router}],\n"
                   "  links: [{ring: 'r[*], x'}], overrides: [{nodes: x, testers: {box: 2}}]}\n",
                   "topology.overrides.0.nodes: only resources have testers; expected such nodes, found 'x'"},
           BadPart{"topology: {shape: graph, nodes: [{name: r, count: 2}], links: [{ring: 'r[*]'}],\n"
                   "  overrides: [{nodes: 'r[*]', testers: {box: 2}}, {resource: 1}]}\n",
                   "topology.overrides.1.resource: resource 1 has an override already"},
           BadPart{"topology: {shape: graph, nodes: [{name: r, count: 2}],\n"
                   "  links: [{ring: 'r[*]', carries: [packets, shapes]}]}\n",
                   "topology.links.0.carries: nothing of the kind shapes travels; expected a node of the kind cache"},
           BadPart{"topology: {shape: graph, nodes: [{name: r, count: 2}],\n"
                   "  links: [{ring: 'r[*]'}, {line: 'r[0], r[1]', carries: []}]}\n",
                   "topology.links.1.carries: a link carries something; expected [packets] for example"},
           BadPart{"topology: {shape: graph, nodes: [{name: r, count: 3}],\n"
                   "  links: [{ring: 'r[*]'}, {from: 'r[0]', to: 'r[2]', carries: []}]}\n",
                   "topology.links.1.carries: a link carries something; expected [packets] for example"},
           BadPart{with_cache("    - {from: 'r[*]', to: l2, both: true, carries: [shapes], depth: 4}\n" + kToMemory),
                   "topology.links.1.depth: a link without packets has room for all there is to carry"},
           BadPart{"topology: {shape: graph, nodes: [{name: r, count: 2}, {name: l2, kind: cache}],\n"
                   "  links: [{line: 'r[*], l2', both: true, latency_cycles: 1, carries: [packets, shapes]}]}\n",
                   "topology.links.0.latency_cycles: packets and others that share r[0] > r[1] take turns"},
           BadPart{with_cache(kToCache + kToMemory) + "memory: {fetch: multicast}\n",
                   "memory.fetch: caches that are drawn do not have this yet; expected resource, found multicast"},
           BadPart{"topology: {shape: graph, nodes: [{name: r}, {name: s, kind: shading, count: 2}],\n"
                   "  links: [{from: r, to: 's[*]', both: true, carries: [new_rays, completed_rays]}]}\n",
                   "topology.nodes.1.kind: no rays come to s[1], as other pools are nearer to all resources"},
           BadPart{"topology: {shape: graph, nodes: [{name: r, count: 2}, {name: s, kind: shading}],\n"
                   "  links: [{ring: 'r[*]'}, {from: s, to: 'r[0]', both: true, carries: [new_rays]}]}\n",
                   "topology.links: there is no way from s to r[1] over links that carry new_rays"}})
    EXPECT_THAT(texts(issues_of(kHead + bad.text)), ElementsAre(HasSubstr(bad.message))) << bad.text;
}

TEST(GraphConfig, BothEnginesTakeItButRanksDoNot) {
  const std::string graph =
      "scene: {builtin: cornell}\ntopology: {shape: graph, nodes: [{name: r, count: 2}], links: [{ring: 'r[*]'}]}\n";
  EXPECT_THAT(texts(issues_of(graph)), IsEmpty());
  EXPECT_THAT(texts(issues_of(graph + "engine: {kind: cycle}\n")), IsEmpty());
  EXPECT_THAT(texts(issues_of(graph + "engine: {transport: mpi}\n")),
              ElementsAre(HasSubstr("topology.shape: the links of a graph are not carried over ranks yet")));
}

}  // namespace
}  // namespace carousel::graph_config_test
