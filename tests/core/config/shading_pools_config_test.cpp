// Pools of shader workers that are drawn: whose rays they shade, their workers, and what is refused by name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/graph/drawn_parts.h"
#include "core/config/load/load.h"
#include "core/config/relaxation.h"
#include "core/config/write.h"
#include "tests/core/config/config_issues.h"

namespace carousel::shading_pools_config_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kHead = "scene: {builtin: cornell}\nengine: {kind: cycle}\n";

/// Six resources on a ring, and these nodes and links. `rest`: further sections.
std::string machine(const std::string& nodes, const std::string& links, const std::string& rest = "") {
  return kHead + rest + "topology:\n  shape: graph\n  nodes:\n    - {name: r, count: 6}\n" + nodes +
         "  links:\n    - {ring: 'r[*]'}\n" + links;
}
std::string to_all(const std::string& rest = "") {
  return "    - {from: 'r[*]', all_to: 's[*]', both: true, carries: [new_rays, completed_rays]" + rest + "}\n";
}

std::vector<std::size_t> pools_of(const std::string& text) {
  const Config config = load_config({text, "test.yaml"}).config;
  std::vector<config::GraphIssue> issues;
  const config::Graph graph = config::draw_graph(config.topology, issues);
  const config::DrawnParts parts = config::find_parts(config.topology, graph, config.memory.line_bytes, issues);
  EXPECT_TRUE(issues.empty()) << issues.front().message;
  return parts.pool_of;
}

TEST(ShadingPoolsConfig, AResourceGoesToTheNearestByLatencyAndOfEqualOnesToTheFirst) {
  // Over a line of routers, a pool at each end; the node's latency counts as well.
  const auto line = [](const std::string& first, const std::string& last) {
    return "    - {name: x, kind: router, count: 6" + first + "}\n    - {name: s, kind: shading, count: 2}\n" + last;
  };
  const std::string links =
      "    - {from: 'r[*]', to: 'x[*]', both: true, latency_cycles: 2, carries: [new_rays, completed_rays]}\n"
      "    - {line: 's[0], x[*], s[1]', both: true, latency_cycles: 3, carries: [new_rays, completed_rays]}\n";
  EXPECT_THAT(pools_of(machine(line("", ""), links)), ElementsAre(0, 0, 0, 1, 1, 1));
  EXPECT_THAT(pools_of(machine(line("", ""), links + "    - {from: 'r[0]', to: 's[1]', latency_cycles: 5, carries: "
                                                     "[completed_rays]}\n")),
              ElementsAre(0, 0, 0, 1, 1, 1));  // 5 and 5 cycles: the first one
  EXPECT_THAT(pools_of(machine(line("", ""), links + "    - {from: 'r[0]', to: 's[1]', latency_cycles: 4, carries: "
                                                     "[completed_rays]}\n")),
              ElementsAre(1, 0, 0, 1, 1, 1));
  EXPECT_THAT(pools_of(machine("    - {name: x, kind: router}\n    - {name: y, kind: router, latency_cycles: 9}\n"
                               "    - {name: s, kind: shading, count: 2}\n",
                               "    - {from: 'r[*]', all_to: 'x, y', both: true, carries: [new_rays]}\n"
                               "    - {from: x, to: 's[1]', both: true, carries: [new_rays]}\n"
                               "    - {from: y, to: 's[0]', both: true, carries: [new_rays]}\n"
                               "    - {from: 's[0]', to: 'r[4]', carries: [new_rays]}\n")),
              ElementsAre(1, 1, 1, 1, 0, 1));  // by the way of new rays, where completed ones have wires
}

// 4 cycles of 4 ns on the way to s[0], with 2 more in its synchroniser and 2 ns in that of the pool: 26 ns.
TEST(ShadingPoolsConfig, TheNearestIsThatOfTheLeastTime) {
  const auto pools = [](int far) {
    return pools_of(machine("    - {name: s, kind: shading, count: 2}\n",
                            "    - {from: 'r[*]', to: 's[0]', both: true, latency_cycles: 4, clock: slow, carries: "
                            "[new_rays, completed_rays]}\n"
                            "    - {from: 'r[0..2]', to: 's[1]', both: true, latency_cycles: 30, carries: [new_rays, "
                            "completed_rays]}\n"
                            "    - {from: 'r[3..5]', to: 's[1]', both: true, latency_cycles: " +
                                std::to_string(far) + ", carries: [new_rays, completed_rays]}\n",
                            "clocks: {slow: 250}\n"));
  };
  EXPECT_THAT(pools(9), ElementsAre(0, 0, 0, 1, 1, 1));
  EXPECT_THAT(pools(25), ElementsAre(0, 0, 0, 1, 1, 1));
  EXPECT_THAT(texts(issues_of(machine("    - {name: s, kind: shading, count: 2}\n",
                                      "    - {from: 'r[*]', to: 's[0]', both: true, latency_cycles: 4, clock: slow, "
                                      "carries: [new_rays, completed_rays]}\n"
                                      "    - {from: 'r[*]', to: 's[1]', both: true, latency_cycles: 26, carries: "
                                      "[new_rays, completed_rays]}\n",
                                      "clocks: {slow: 250}\n"))),
              ElementsAre(HasSubstr("no rays come to s[1]")));  // 26 and 26 ns: the first one
}

TEST(ShadingPoolsConfig, APoolTakesTheResourcesThatItServes) {
  EXPECT_THAT(pools_of(machine("    - {name: s, kind: shading, count: 3, serves: 'r[5..0]'}\n", to_all())),
              ElementsAre(2, 2, 1, 1, 0, 0));
  EXPECT_THAT(pools_of(machine("    - {name: a, kind: shading}\n    - {name: b, kind: shading, serves: 'r[1..2]'}\n",
                               "    - {from: 'r[*]', all_to: 'a, b', both: true, carries: [completed_rays]}\n")),
              ElementsAre(0, 1, 1, 0, 0, 0));
}

TEST(ShadingPoolsConfig, WorkersAreNamedOrShared) {
  const auto workers = [](const std::string& nodes, const std::string& rest = "") {
    return pool_workers(load_config({machine(nodes, to_all(", latency_cycles: 2"), rest), "test.yaml"}).config);
  };
  const std::string own = "    - {name: s, kind: shading, count: 3, serves: 'r[*]'";
  EXPECT_THAT(workers(own + "}\n"), ElementsAre(4, 4, 4));  // two for each resource
  EXPECT_THAT(workers(own + "}\n", "shading: {workers: 8}\n"), ElementsAre(3, 3, 2));
  EXPECT_THAT(workers(own + ", workers: 5}\n"), ElementsAre(5, 5, 5));
  const auto mixed = [](const std::string& rest) {
    const Config config =
        load_config({machine("    - {name: a, kind: shading, workers: 3, serves: 'r[0]'}\n    - {name: s, kind: "
                             "shading, count: 2, serves: 'r[1..4]'}\n    - {name: z, kind: shading}\n",
                             "    - {from: 'r[*]', all_to: 'a, s[*], z', both: true, carries: [new_rays]}\n", rest),
                     "test.yaml"})
            .config;
    std::vector<std::int64_t> out = pool_workers(config);
    out.push_back(shader_workers(config));
    return out;
  };
  EXPECT_THAT(mixed(""), ElementsAre(3, 3, 3, 3, 12));
  EXPECT_THAT(mixed("shading: {workers: 10}\n"), ElementsAre(3, 3, 2, 2, 10));
}

// The search for the bottleneck doubles the workers of all pools.
TEST(ShadingPoolsConfig, RelaxingShadingDoublesEveryPool) {
  for (const std::string rest : {"", ", workers: 5"})
    for (const std::string shading : {"", "shading: {workers: 12}\n"}) {
      if (!rest.empty() && !shading.empty()) continue;
      Config config = load_config({machine("    - {name: s, kind: shading, count: 3, serves: 'r[*]'" + rest + "}\n",
                                           to_all(), shading),
                                   "test.yaml"})
                          .config;
      const std::vector<std::int64_t> before = pool_workers(config);
      bool found = false;
      for (const Relaxation& one : relaxations(config, [](const std::string&) { return true; }))
        if (one.part == "shading") {
          relax(config, one);
          found = true;
        }
      EXPECT_TRUE(found);
      const std::vector<std::int64_t> after = pool_workers(config);
      for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(after[i], 2 * before[i]);
    }
}

TEST(ShadingPoolsConfig, IsWrittenAndReadAgain) {
  const Config config =
      load_config(
          {machine("    - {name: s, kind: shading, count: 2, workers: 3, serves: 'r[*]'}\n", to_all()), "a.yaml"})
          .config;
  const std::string text = resolved_yaml(config);
  EXPECT_EQ(parse_config(text, "again.yaml").topology.nodes, config.topology.nodes) << text;
}

struct Bad {
  std::string text, message;
};

TEST(ShadingPoolsConfig, WhatCannotWorkIsRefusedByName) {
  const std::string two = "    - {name: s, kind: shading, count: 2, serves: 'r[*]'}\n";
  for (const Bad& bad :
       {Bad{machine("    - {name: s, kind: shading, count: 2}\n", to_all()),
            "topology.nodes.1.kind: no rays come to s[1], as other pools are nearer to all resources, or serve them"},
        Bad{machine("    - {name: s, kind: shading, count: 2, serves: 'r[0..3]'}\n", to_all()),
            "topology.nodes: no pool of workers shades the rays of r[4]; expected a node of the kind shading"},
        Bad{machine("    - {name: s, kind: shading, count: 4, serves: 'r[*]'}\n", to_all()),
            "topology.nodes.1.serves: each of 4 pools serves as many; expected a multiple of 4 resources, found 6"},
        Bad{machine("    - {name: s, kind: shading, serves: 'q[*]'}\n",
                    "    - {from: s, to: 'r[*]', both: true, carries: [new_rays]}\n"),
            "topology.nodes.1.serves: expected a node, found 'q'"},
        Bad{machine("    - {name: s, kind: shading, serves: s}\n",
                    "    - {from: s, to: 'r[*]', both: true, carries: [new_rays]}\n"),
            "topology.nodes.1.serves: workers shade the rays of resources; expected such nodes, found s"},
        Bad{machine("    - {name: a, kind: shading, serves: 'r[0..3]'}\n    - {name: b, kind: shading, serves: "
                    "'r[3..5]'}\n",
                    "    - {from: 'r[*]', all_to: 'a, b', both: true, carries: [new_rays]}\n"),
            "topology.nodes.2.serves: a serves r[3] already"},
        Bad{machine(two,
                    "    - {from: 's[0]', to: 'r[*]', carries: [new_rays]}\n"
                    "    - {from: 's[1]', to: 'r[3]', carries: [new_rays]}\n"),
            "topology.links: there is no way from s[1] to r[4] over links that carry new_rays"},
        Bad{kHead + "topology: {shape: graph, nodes: [{name: r, count: 2, workers: 3}], links: [{ring: 'r[*]'}]}\n",
            "topology.nodes.0.workers: only a node of the kind shading has workers; expected none at a resource, "
            "found 3"},
        Bad{machine("    - {name: s, kind: shading, count: 2, serves: 'r[*]', workers: 200}\n", to_all()),
            "topology.nodes: all pools together have 400 workers; expected at most 256"},
        Bad{machine("    - {name: s, kind: shading, count: 2, serves: 'r[*]', workers: 2}\n", to_all(),
                    "shading: {workers: 4}\n"),
            "shading.workers: each node of the kind shading names its workers; expected auto, found 4"},
        Bad{machine(two, to_all(), "shading: {workers: 1}\n"),
            "topology.nodes: of shading.workers, 1, pools that name theirs have 0, and 2 pools share the rest; "},
        Bad{machine("    - {name: a, kind: shading, serves: 'r[0..2]', workers: 3}\n    - {name: b, kind: shading}\n",
                    "    - {from: 'r[*]', all_to: 'a, b', both: true, carries: [new_rays]}\n",
                    "shading: {workers: 3}\n"),
            "topology.nodes: of shading.workers, 3, pools that name theirs have 3, and 1 pool has the rest; "},
        Bad{machine(two, to_all(), "rays: {placement: first_taker}\n"),
            "rays.placement: several nodes of the kind shading do not have this yet; expected balanced, found "
            "first_taker, or one such node"},
        Bad{machine(two, to_all(), "memory: {ray_records: master}\n"),
            "memory.ray_records: several nodes of the kind shading do not have this yet"},
        Bad{machine(two, to_all(), "memory: {path_state: memory}\n"),
            "memory.path_state: several nodes of the kind shading do not have this yet"},
        Bad{machine(two, to_all(), "memory: {film: memory}\n"),
            "memory.film: several nodes of the kind shading do not have this yet"},
        Bad{machine(two, to_all(), "memory: {surfaces: memory}\n"),
            "memory.surfaces: several nodes of the kind shading do not have this yet"},
        Bad{machine(two, to_all(), "shading: {program: {default: built_in}}\n"),
            "shading.program.default: several nodes of the kind shading do not have this yet; expected constant"},
        Bad{machine(two, to_all(), "faults: {resource: {number: 1, kind: stop}}\n"),
            "faults.resource.kind: several nodes of the kind shading do not have this yet"}})
    EXPECT_THAT(texts(issues_of(bad.text)), ElementsAre(HasSubstr(bad.message))) << bad.text;
}

// A packet process keeps the rays of its resources together: they go to one pool.
TEST(ShadingPoolsConfig, ResourcesOfAPacketProcessHaveOnePool) {
  const auto text = [](const std::string& serves) {
    return kHead +
           "topology:\n  shape: graph\n  nodes:\n    - {name: r, count: 4}\n    - {name: p, kind: packet_process, "
           "count: 2, serves: 'r[*]'}\n    - {name: l2, kind: cache}\n    - {name: s, kind: shading" +
           serves +
           "}\n    - {name: t, kind: shading}\n  links:\n    - {from: 'p[*]', all_to: 'r[*]', both: true}\n"
           "    - {from: 'r[*]', to: l2, both: true, carries: [shapes]}\n"
           "    - {from: 'r[*], p[*]', all_to: 's, t', both: true, carries: [new_rays, completed_rays]}\n";
  };
  EXPECT_THAT(pools_of(text(", serves: 'r[2]'")), ElementsAre(1, 1, 0, 0, 1, 0));
  EXPECT_THAT(texts(issues_of(text(", serves: 'r[*]'"))), ElementsAre(HasSubstr("no rays come to t")));
}

TEST(ShadingPoolsConfig, TheNativeEngineTakesThem) {
  std::string native = machine("    - {name: s, kind: shading, count: 2, serves: 'r[*]'}\n", to_all());
  native.replace(native.find("engine: {kind: cycle}"), 21, "engine: {kind: native}");
  EXPECT_THAT(texts(issues_of(native)), IsEmpty());
  native.insert(native.rfind(", carries:"), ", queue: spsc_ring");
  EXPECT_THAT(texts(issues_of(native)), ElementsAre(HasSubstr("topology.links.1.queue: in the native engine rays go")));
}

}  // namespace
}  // namespace carousel::shading_pools_config_test
