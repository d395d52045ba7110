// Packet processes that serve resources: what is read, and what is refused and where.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/graph/graph.h"
#include "core/config/key_conditions.h"
#include "core/config/own_sections.h"
#include "tests/core/config/config_issues.h"

namespace carousel::packet_process_config_test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

/// Four resources with a cache, and these nodes, all of which have links there and back with the resources named.
std::string machine(const std::string& nodes, const std::string& links, const std::string& more = "") {
  return "scene: {builtin: cornell}\nengine: {kind: cycle}\ntopology:\n  shape: graph\n  nodes:\n"
         "    - {name: r, count: 4}\n    - {name: l2, kind: cache}\n" +
         nodes + "  links:\n    - {from: 'r[*]', to: l2, both: true, carries: [shapes]}\n" + links + more;
}
const std::string kOne = "    - {name: p, kind: packet_process, serves: 'r[*]'}\n";
const std::string kStar = "    - {from: 'r[*]', to: p, both: true}\n";

std::vector<std::string> refusal(const std::string& nodes, const std::string& links = kStar,
                                 const std::string& more = "") {
  return texts(issues_of(machine(nodes, links, more)));
}

TEST(PacketProcessConfig, AGroupServesEqualRuns) {
  const Config config = parse_config(machine("    - {name: p, kind: packet_process, count: 2, serves: 'r[3..0]'}\n",
                                             "    - {from: 'r[*]', all_to: 'p[*]', both: true}\n"),
                                     "test.yaml");
  std::vector<config::GraphIssue> issues;
  const config::Graph graph = config::draw_graph(config.topology, issues);
  ASSERT_TRUE(issues.empty());
  EXPECT_THAT(graph.manager_of, ElementsAre(5, 5, 4, 4, 4, 5));
  EXPECT_THAT(graph.issuers(), ElementsAre(4, 5));
  EXPECT_TRUE(graph.packets_go(0, 1));
  EXPECT_TRUE(graph.packets_go(5, 0));
  EXPECT_FALSE(graph.packets_go(1, 2));
  EXPECT_EQ(config.topology.resources, 6);
  EXPECT_EQ(ray_owners(config.topology), 4);
  EXPECT_FALSE(is_central(config.topology));
}

// Rays, testers and buffers are at resources alone, collections at packet processes alone.
TEST(PacketProcessConfig, NothingIsBuiltTwice) {
  const Config config = parse_config(machine(kOne, kStar, "memory: {l1_kib: 16}\n"), "test.yaml");
  EXPECT_EQ(all_slots(config), 4 * config.rays.slots_per_resource);
  const auto sum = [&](const auto& of) { return sum_of_resources(config, of); };
  EXPECT_EQ(sum([](const OwnSections& one) { return one.collections.capacity; }), config.collections.capacity);
  EXPECT_EQ(sum([](const OwnSections& one) { return one.memory.shape_buffer_kib; }),
            4 * config.memory.shape_buffer_kib);
  EXPECT_EQ(sum([](const OwnSections& one) { return one.memory.l1_kib; }), 4 * 16);
  EXPECT_EQ(sum([](const OwnSections& one) { return one.testers.units[UnitKind::kBox].units; }),
            4 * config.testers.units[UnitKind::kBox].units);
  EXPECT_EQ(shader_workers(config), 8);
}

TEST(PacketProcessConfig, WrongNamesHaveTheirPlace) {
  EXPECT_THAT(
      refusal("    - {name: p, kind: packet_process, serves: 's[*]'}\n"),
      ElementsAre(AllOf(StartsWith("test.yaml:8:47: topology.nodes.2.serves: "), HasSubstr("known are l2, p, r"))));
  EXPECT_THAT(
      refusal("    - {name: p, kind: packet_process, serves: 'r[*], l2'}\n"),
      ElementsAre("test.yaml:8:47: topology.nodes.2.serves: a packet_process keeps the collections of resources; "
                  "expected such nodes, found l2"));
  EXPECT_THAT(refusal(kOne + "    - {name: q, kind: packet_process, serves: 'r[2]'}\n",
                      kStar + "    - {from: 'r[2]', to: q, both: true}\n"),
              ElementsAre("test.yaml:9:47: topology.nodes.3.serves: p serves r[2] already; expected one packet_process "
                          "for each resource"));
  EXPECT_THAT(refusal("    - {name: p, kind: packet_process, serves: 'r[0..2]'}\n"),
              ElementsAre(HasSubstr("topology.nodes: no packet_process serves r[3]; expected one that does")));
  EXPECT_THAT(refusal("    - {name: p, kind: packet_process, count: 3, serves: 'r[*]'}\n",
                      "    - {from: 'r[*]', all_to: 'p[*]', both: true}\n"),
              ElementsAre(HasSubstr("topology.nodes.2.serves: each of 3 packet processes serves as many; expected a "
                                    "multiple of 3 resources, found 4")));
  EXPECT_THAT(
      refusal(kOne, "    - {from: 'r[0..2]', to: p, both: true}\n    - {from: 'r[3]', to: p}\n"),
      ElementsAre(HasSubstr("topology.links: there is no way from r[0] to r[3]; expected links that lead there")));
}

// Nothing goes from the resources of one to those of another, so no way is needed.
TEST(PacketProcessConfig, MachinesSideBySideNeedNoWayBetweenThem) {
  EXPECT_TRUE(refusal("    - {name: p, kind: packet_process, count: 2, serves: 'r[*]'}\n",
                      "    - {from: 'r[0..1]', to: 'p[0]', both: true}\n    - {from: 'r[2..3]', to: 'p[1]', both: "
                      "true}\n")
                  .empty());
}

TEST(PacketProcessConfig, WhatItDoesNotHaveIsRefused) {
  const auto refused = [](const std::string& more, const char* message) {
    EXPECT_THAT(refusal(kOne, kStar, more), Contains(HasSubstr(message))) << more;
  };
  refused("collections: {home: hash}\n",
          "collections.home: the packet_process keeps the collections of its resources; expected issuer, found hash");
  refused("collections: {when_full: spill}\n",
          "collections.when_full: p has no memory to spill to; expected reserve, or a cache that serves p");
  refused("rays: {placement: first_taker}\n", "rays.placement: new rays go to the resources of one packet_process");
  refused("shading: {idle_resources_shade: true}\n", "shading.idle_resources_shade: ");
  refused("  visit: all\n", "topology.visit: a packet visits resources of its packet_process alone");
  refused("  overrides: [{nodes: p, slots_per_resource: 4}]\n",
          "topology.overrides.0.slots_per_resource: a packet_process that serves resources has collections alone");
  refused("  overrides: [{nodes: p, testers: {contexts: 3}}]\n", "topology.overrides.0.testers: ");
  refused("  overrides: [{nodes: 'r[0]', sort_ids_per_cycle: 4}]\n",
          "topology.overrides.0.sort_ids_per_cycle: a packet_process collects the rays of these resources");
  refused("  overrides: [{nodes: 'r[0]', fetch_ahead: 4}]\n", "topology.overrides.0.fetch_ahead: ");
  EXPECT_TRUE(refusal(kOne, kStar, "  overrides: [{nodes: p, sort_ids_per_cycle: 4}]\n").empty());
  EXPECT_TRUE(refusal(kOne, kStar, "  overrides: [{nodes: 'r[*], p', ids_per_cycle: 4, ready: 4}]\n").empty());
  EXPECT_THAT(refusal(kOne + "    - {name: q, kind: packet_process}\n", kStar + "    - {from: q, to: p, both: true}\n"),
              Contains(HasSubstr("topology.nodes: each packet_process serves resources, or each has its own cells")));
  EXPECT_THAT(texts(issues_of("scene: {builtin: cornell}\nengine: {kind: cycle}\ntopology: {shape: graph, nodes: "
                              "[{name: r, count: 2}, {name: p, kind: packet_process, serves: 'r[*]'}], links: [{from: "
                              "'r[*]', to: p, both: true}]}\n")),
              Contains(HasSubstr("expected a node of the kind cache")));
}

// A fault needs a part that has it, and another that goes on when one stops.
TEST(PacketProcessConfig, FaultsHaveAPlace) {
  const std::string two = "    - {name: p, kind: packet_process, count: 2, serves: 'r[*]'}\n";
  const std::string links = "    - {from: 'r[*]', all_to: 'p[*]', both: true}\n";
  const auto fault = [](const std::string& kind, int number) {
    return "faults: {resource: {kind: " + kind + ", number: " + std::to_string(number) + "}}\n";
  };
  for (const char* kind : {"pause", "stop"})
    for (const int number : {0, 3, 4, 5}) EXPECT_TRUE(refusal(two, links, fault(kind, number)).empty()) << number;
  EXPECT_THAT(
      refusal(two, links, fault("slow", 5)),
      ElementsAre(HasSubstr("faults.resource.number: a packet_process that serves resources has no testers that "
                            "could be slow; expected a resource from 0 to 3, found 5")));
  EXPECT_THAT(refusal(kOne, kStar, fault("stop", 4)),
              ElementsAre(HasSubstr("faults.resource.number: when a packet_process stops, another one has to continue, "
                                    "and there is no other; expected a resource from 0 to 3, found 4")));
  EXPECT_TRUE(refusal(kOne, kStar, fault("pause", 4)).empty());
  const std::string native =
      "scene: {builtin: cornell}\nengine: {kind: native}\ntopology: {shape: graph, nodes: [{name: r, count: 2}, {name: "
      "p, kind: packet_process, serves: 'r[*]'}], links: [{from: 'r[*]', to: p, both: true}]}\n";
  EXPECT_THAT(texts(issues_of(native + fault("stop", 2))),
              ElementsAre(HasSubstr("faults.resource.number: when a packet_process stops, another one has to continue, "
                                    "and there is no other; expected a resource from 0 to 1, found 2")));
  EXPECT_THAT(texts(issues_of(native + fault("pause", 2))), testing::IsEmpty());
  EXPECT_THAT(
      texts(issues_of("scene: {builtin: cornell}\nengine: {kind: cycle}\ntopology: {shape: graph, nodes: "
                      "[{name: r}, {name: p, kind: packet_process, serves: r}, {name: l2, kind: cache}], links: "
                      "[{from: r, to: p, both: true}, {from: r, to: l2, both: true, carries: [shapes]}]}\n" +
                      fault("stop", 0))),
      ElementsAre(HasSubstr("faults.resource.number: when a resource stops, another that owns rays has to "
                            "continue; expected two resources at least, found 0")));
}

// A packet process has no rays, so there is no order in which an issuer tests its own.
TEST(PacketProcessConfig, KeysOfIssuersWithRaysAreNotFelt) {
  const Config config = parse_config(machine(kOne, kStar), "test.yaml");
  EXPECT_EQ(unused_because(config, {}, "testers.own_rays"),
            "the packet_process that issues packets has no rays of its own");
}

}  // namespace
}  // namespace carousel::packet_process_config_test
