// Drawings whose resources trace their own rays (topology.trace: stacks): what is read, and what is refused and where.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/key_conditions.h"
#include "core/config/load/ignored_keys.h"
#include "core/config/write.h"
#include "tests/core/config/config_issues.h"

namespace carousel::stack_config_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Four resources, with these nodes and links besides. The first line of `more` is line 9.
std::string machine(const std::string& nodes, const std::string& links, const std::string& more = "") {
  return "scene: {builtin: cornell}\nengine: {kind: cycle}\ntopology:\n  shape: graph\n  trace: stacks\n"
         "  nodes: [{name: r, count: 4}" +
         nodes + "]\n  links: [" + links + "]\n" + more;
}
const std::string kCache = ", {name: l2, kind: cache}";
const std::string kToCache = "{from: 'r[*]', to: l2, both: true, carries: [shapes]}";

TEST(StackConfig, ResourcesNeedNoLinks) {
  const Config config = parse_config(machine("", ""), "test.yaml");
  EXPECT_EQ(config.topology.trace, Tracing::kStacks);
  EXPECT_EQ(config.topology.resources, 4);
  EXPECT_FALSE(properties_of(config.topology).has_packets);
  EXPECT_EQ(parse_config(resolved_yaml(config), "again.yaml").topology.trace, Tracing::kStacks);
}

TEST(StackConfig, ReadsCachesWarpsAndOverrides) {
  const Config config =
      parse_config(machine(kCache, kToCache,
                           "  overrides: [{nodes: 'r[2]', testers: {box: {units: 9}}}]\ntesters: {simt: {warp: 8}}\n"),
                   "test.yaml");
  EXPECT_THAT(config.topology.overrides.at(0).named, ElementsAre(2));
}

TEST(StackConfig, KeysOfPacketsHaveNoEffect) {
  const Config config = parse_config(machine(kCache, kToCache), "test.yaml");
  for (const char* key : {"topology.visit", "topology.flow", "topology.link.depth", "topology.routes", "topology.root",
                          "topology.ways", "topology.tour", "collections.capacity", "memory.shared_by", "clocks.noc"})
    EXPECT_EQ(unused_because(config, {}, key).has_value(), std::string_view(key) != "clocks.noc") << key;
  EXPECT_FALSE(unused_because(config, {}, "topology.trace"));
  EXPECT_EQ(unused_because(parse_config(machine("", ""), "test.yaml"), {}, "clocks.noc"),
            "the network has the clock of the resources");
  EXPECT_EQ(unused_because(parse_config("scene: {builtin: cornell}\n", "test.yaml"), {}, "topology.trace"),
            "the topology is not drawn");
}

// A resource's own number is felt where that of all resources is.
TEST(StackConfig, NamesWhatResourcesOfTheirOwnCannotFeel) {
  const auto unfelt = [](std::string text) {
    std::vector<std::string> out;
    for (const IgnoredKey& one : ignored_keys(load_config({std::move(text), "test.yaml"}, {}, {}), {}))
      out.push_back(fmt::format("{} at {}", one.key, one.position.line));
    return out;
  };
  const std::string own = "  overrides: [{nodes: 'r[2]', capacity: 9000, slots_per_resource: 64, ids_per_cycle: 2}]\n";
  EXPECT_THAT(unfelt(machine(kCache, kToCache, own)),
              ElementsAre("topology.overrides.0.capacity at 8", "topology.overrides.0.ids_per_cycle at 8"));
  EXPECT_THAT(unfelt("scene: {builtin: cornell}\nengine: {kind: cycle}\ntopology:\n  shape: graph\n  nodes: [{name: r, "
                     "count: 4, capacity: 9000, partial_after_cycles: 9}]\n  links: [{ring: 'r[*]'}]\n"),
              ElementsAre("topology.nodes.0.partial_after_cycles at 5"));
  EXPECT_THAT(unfelt("scene: {builtin: cornell}\ntopology: {overrides: [{resource: 1, fetch_ahead: 3}]}\n"),
              ElementsAre("topology.overrides at 2"));
}

struct BadStack {
  const char* name;
  std::string text;
  const char* message;
};

class BadStacks : public testing::TestWithParam<BadStack> {};

TEST_P(BadStacks, AreRefusedByName) {
  EXPECT_THAT(texts(issues_of(GetParam().text)), ElementsAre(HasSubstr(GetParam().message)));
}

INSTANTIATE_TEST_SUITE_P(
    All, BadStacks,
    testing::Values(
        BadStack{"Native",
                 "scene: {builtin: cornell}\ntopology: {shape: graph, trace: stacks, nodes: [{name: r, count: 2}]}\n",
                 "test.yaml:2:33: topology.trace: the native engine has no stacks; expected packets"},
        BadStack{"PacketLinks", machine("", "{ring: 'r[*]'}"),
                 "test.yaml:7:11: topology.links.0.carries: resources that trace their own rays send no packets; "
                 "expected shapes, new_rays or completed_rays, or topology.trace: packets; found packets"},
        BadStack{"SharedLinks", machine(kCache, "{from: 'r[*]', to: l2, both: true, carries: [packets, shapes]}"),
                 "test.yaml:7:55: topology.links.0.carries: resources that trace their own rays send no packets"},
        BadStack{
            "Process",
            machine(", {name: p, kind: packet_process, serves: 'r[*]'}" + kCache,
                    kToCache + ", {from: p, to: l2, both: true, carries: [shapes]}"),
            "test.yaml:6:48: topology.nodes.1.kind: resources that trace their own rays have no packets, which are "
            "all that a packet_process is for; expected another kind, or topology.trace: packets; found "
            "packet_process"},
        BadStack{
            "Bus",
            machine(", {name: b, kind: bus}" + kCache, kToCache + ", {from: b, to: l2, both: true, carries: [shapes]}"),
            "test.yaml:6:48: topology.nodes.1.kind: resources that trace their own rays have no packets, which are "
            "all that a bus is for"},
        BadStack{"Places",
                 machine(", {name: x, kind: router, buffers: 4}" + kCache,
                         "{from: 'r[*]', to: x, both: true, carries: [shapes]}, {from: x, to: l2, both: "
                         "true, carries: [shapes]}"),
                 "test.yaml:6:65: topology.nodes.1.buffers: every node has room for all messages, and no packets wait "
                 "there; expected auto, or topology.trace: packets"},
        BadStack{"NoMemory",
                 machine(", {name: l2, kind: cache, serves: 'r[0..2]'}",
                         "{from: 'r[0..2]', to: l2, both: true, carries: [shapes]}"),
                 "test.yaml:6:10: topology.nodes: r[3] has no memory: no cache serves it"},
        BadStack{"NoWay", machine(kCache, "{from: 'r[0..2]', to: l2, both: true, carries: [shapes]}"),
                 "test.yaml:7:10: topology.links: there is no way from r[3] to l2 over links that carry shapes"},
        BadStack{"LooseNode", machine(", {name: x, kind: router}" + kCache, kToCache),
                 "test.yaml:6:32: topology.nodes.1: x has no link"},
        BadStack{"NoCache", machine("", "{ring: 'r[*]', carries: [shapes]}"),
                 "test.yaml:7:35: topology.links.0.carries: nothing of the kind shapes travels; expected a node of the "
                 "kind cache, or links without them"},
        BadStack{"Stops",
                 machine(", {name: x, kind: router, count: 3}" + kCache,
                         "{from: 'r[*]', to: 'x[0]', both: true, carries: [shapes]}, {ring: 'x[*]', both: true, "
                         "carries: [shapes], stops: {rule: slots}}, {from: 'x[1]', to: l2, both: true, carries: "
                         "[shapes]}"),
                 "topology.links.1.carries: a ring with rule: slots has no queues and carries packets; expected stops: "
                 "{rule: queues}"},
        BadStack{"Bundles", machine("", "", "bundles: {size: 4}\n"),
                 "test.yaml:5:10: topology.trace: independent resources trace single rays; expected packets, found "
                 "stacks, or bundles.size: 0"},
        BadStack{
            "LinkFaults", machine("", "", "faults: {links: {drop: 0.1}}\n"),
            "faults.links: no link of this graph carries packets, and others have no faults; expected no faults of "
            "links, or topology.trace: packets"},
        BadStack{"Window", machine("", "", "testers: {window: 2}\n"),
                 "testers.window: topology.trace: stacks has no input queues; expected 1, found 2"}),
    [](const auto& one) { return one.param.name; });

// Such reads would never be answered.
TEST(StackConfig, ProgramsThatReadDataNeedCachesThatAreNotDrawn) {
  const std::string programs =
      "shading: {program: {default: a}}\nprograms: {shaders: {a: {program: ['add x, hit, hit'%]}}}\n";
  const auto with = [&](const std::string& more) {
    std::string text = programs;
    return text.replace(text.find('%'), 1, more);
  };
  EXPECT_THAT(texts(issues_of(machine(kCache, kToCache, with("")))), ElementsAre());
  EXPECT_THAT(texts(issues_of(machine("", "", with(", 'texture y, x'")))), ElementsAre());
  EXPECT_THAT(texts(issues_of(machine(kCache, kToCache, with(", 'texture y, x'")))),
              ElementsAre(HasSubstr("test.yaml:8:20: shading.program: caches that are drawn have no ports for data of "
                                    "shader programs yet")));
}

TEST(StackConfig, TrafficNeedsPackets) {
  const std::vector<std::string> found = texts(issues_of(machine("", "", "workload: {traffic: {rate: 0.1}}\n")));
  EXPECT_THAT(found, testing::Contains(HasSubstr(
                         "test.yaml:5:10: topology.trace: synthetic traffic goes in packets; expected packets, found "
                         "stacks")));
}

}  // namespace
}  // namespace carousel::stack_config_test
