// Numbers in which resources differ: where they are said, whom they reach, and what cannot differ.
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/config/load/ignored_keys.h"
#include "core/config/load/load.h"
#include "core/config/own_sections.h"
#include "core/config/schema.h"
#include "core/config/write.h"
#include "tests/core/config/bad_config.h"

namespace carousel::own_keys_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kHead = "scene: {builtin: cornell}\nengine: {kind: cycle}\nmemory: {l1_kib: 32}\n";

Config with_nodes(const std::string& own) {
  return parse_config(kHead + "topology:\n  shape: graph\n  nodes: [{name: a, count: 2}, {name: b, count: 2, " + own +
                          "}]\n  links: [{ring: 'a[*], b[*]'}]\n",
                      "test.yaml");
}

// A value of each row, which the whole machine has not, reaches the resources of its node, or of its override, and no
// others; and what a run writes says so again.
TEST(OwnKeys, EachReachesItsResources) {
  config::for_each_own_key([](const auto& row) {
    SCOPED_TRACE(row.path);
    const OwnSections plain = own_sections(with_nodes("kind: resource"), 0);
    const std::int64_t all = row.of(plain), own = all == row.range.max ? all - 1 : 2 * std::max<std::int64_t>(all, 1);
    for (const bool by_node : {true, false}) {
      const std::string number = fmt::format("{}: {}", row.name, own);
      const Config config = by_node ? with_nodes(number)
                                    : parse_config(kHead + "topology: {resources: 4, overrides: [{resource: 2, " +
                                                       number + "}, {resource: 3, " + number + "}]}\n",
                                                   "test.yaml");
      const Config again = parse_config(resolved_yaml(config), "again.yaml");
      for (const Config& one : {config, again})
        for (std::int64_t r = 0; r < 4; ++r) {
          const OwnSections sections = own_sections(one, r);
          EXPECT_EQ(row.of(sections), r < 2 ? all : own) << r;
        }
    }
  });
}

// The list says again what the keys of the whole machine say.
TEST(OwnKeys, HaveTheRangesOfTheWholeMachine) {
  const nlohmann::ordered_json schema = config_schema();
  config::for_each_own_key([&](const auto& row) {
    SCOPED_TRACE(row.path);
    const std::string path = row.path;
    const std::size_t dot = path.find('.');
    const auto& of = schema["properties"][path.substr(0, dot)]["properties"][path.substr(dot + 1)];
    EXPECT_EQ(of["maximum"], row.range.max);
    EXPECT_EQ(of["unit"], row.name == "capacity" ? "ray IDs per resource" : row.unit);
    // A cache of nothing is none, which all resources have or not.
    if (row.name != "l1_kib") {
      EXPECT_EQ(of["minimum"], row.range.min);
    }
    EXPECT_TRUE(path.ends_with("." + std::string(row.name)));
  });
}

TEST(OwnKeys, TestersOfANodeBeginWithThoseOfTheWholeMachine) {
  const Config config = with_nodes("testers: {box: {units: 3}}");
  EXPECT_EQ(own_sections(config, 1).testers.units[UnitKind::kBox].units, config.testers.units[UnitKind::kBox].units);
  EXPECT_EQ(own_sections(config, 2).testers.units[UnitKind::kBox].units, 3);
  EXPECT_EQ(own_sections(config, 3).testers.units[UnitKind::kBox].latency_cycles,
            config.testers.units[UnitKind::kBox].latency_cycles);
}

TEST(OwnKeys, AreAddedUp) {
  EXPECT_EQ(all_slots(with_nodes("slots_per_resource: 8")), 2 * 1024 + 2 * 8);
}

// At a node as in an override.
TEST(OwnKeys, AreNamedWhereTheNativeEngineHasEqualResources) {
  const std::string own = "{testers: {box: {units: 3}}, slots_per_resource: 8, ";
  const auto named = [&](const std::string& engine) {
    std::vector<std::string> out;
    const std::string text = "scene: {builtin: cornell}\nengine: {kind: " + engine +
                             "}\ntopology: {shape: graph, nodes: [" + own +
                             "name: a}, {name: b}], links: [{ring: 'a, b'}], overrides: [" + own + "resource: 1}]}\n";
    for (const IgnoredKey& key : ignored_keys(load_config({text, "test.yaml"}), {})) out.push_back(key.key);
    return out;
  };
  EXPECT_THAT(named("native"),
              ElementsAre("topology.nodes.0.slots_per_resource", "topology.nodes.0.testers", "topology.overrides"));
  EXPECT_THAT(named("cycle"), ElementsAre());
}

struct Refused {
  std::string text, message;
};

TEST(OwnKeys, WhatAllResourcesShareIsRefusedByName) {
  const std::string node = "topology: {shape: graph, links: [{ring: 'r[*]'}], nodes: [{name: r, count: 2, ";
  for (const Refused& bad : {
           Refused{"topology: {overrides: [{resource: 1, l2_kib: 64}]}\n",
                   "test.yaml:4:38: topology.overrides.0.l2_kib: memory.l2_kib is the same for all resources: an L2 "
                   "serves several resources; expected testers, slots_per_resource, "},
           Refused{node + "policy: oldest}]}\n",
                   "topology.nodes.0.policy: collections.policy is the same for all resources: packets that one "
                   "resource makes are tested by others"},
           Refused{node + "rays: {slots_per_resource: 4}}]}\n",
                   "topology.nodes.0.rays: what a resource has of `rays` stands here without the section; expected "
                   "slots_per_resource, reads_per_cycle"},
           Refused{node + "slots_per_resorce: 4}]}\n", "unknown key; did you mean 'slots_per_resource'?"},
           Refused{
               node + "slots_per_resource: 0}]}\n",
               "topology.nodes.0.slots_per_resource: expected auto or an integer from 1 to 4194304 (rays), found 0"},
           Refused{node + "l1_kib: 16}]}\n",
                   "topology.nodes.0.l1_kib: all resources have a cache of their own, or none; expected auto, or "
                   "memory.l1_kib of at least 1; found 16"},
           Refused{"memory: {l1_kib: 32}\n" + node + "l1_ways: 7}]}\n",
                   "topology.nodes.0.l1_ways: a cache has whole sets, of 7 lines of 64 bytes; expected a multiple of 7 "
                   "KiB, found 32"},
           Refused{node + "slots_per_resource: 4}, {name: x, kind: router, ready: 4}]}\n",
                   "topology.nodes.1.ready: only a resource has this key; expected none at a router, found 4"},
           Refused{node + "ready: 4}], overrides: [{resource: 1, ready: 8}]}\n",
                   "topology.overrides.0.resource: resource 1 has numbers of its own in topology.nodes.0 already; "
                   "expected one of the two places"},
           Refused{node + "testers: {simt: {warp: 8}}}]}\n",
                   "topology.nodes.0.testers.simt.warp: warps are of resources that trace their own rays, not those of "
                   "packets"},
           Refused{"topology: {shape: independent, resources: 2, overrides: [{resource: 1, slots_per_resource: 16, "
                   "testers: {simt: {warp: 32}}}]}\n",
                   "topology.overrides.0.testers.simt.warp: no warp would ever be full; expected at most "
                   "rays.slots_per_resource = 16, found 32"},
       }) {
    const std::string head = bad.text.starts_with("memory") ? "" : "memory: {l1_kib: 0}\n";
    EXPECT_THAT(texts(issues_of("scene: {builtin: cornell}\nengine: {kind: cycle}\n" + head + bad.text)),
                testing::Contains(HasSubstr(bad.message)))
        << bad.text;
  }
}

}  // namespace
}  // namespace carousel::own_keys_test
