// Machines that are drawn with several pools of shader workers: results, report, series and page.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel::drawn_pools_test {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

const std::string kScene =
    "scene: {builtin: terrain, triangles: 600}\nimage: {width: 24, height: 16}\nrays: {slots_per_resource: 64}\n"
    "packets: {rays: 8}\n";

/// Two pools, near and far, whose rays share links, and a link of rays beside one of packets.
const std::string kPools =
    "topology:\n  shape: graph\n  nodes:\n    - {name: r, count: 6}\n    - {name: x, kind: router}\n"
    "    - {name: near, kind: shading, workers: 3}\n    - {name: far, kind: shading, workers: 2}\n  links:\n"
    "    - {ring: 'r[*], x'}\n    - {from: 'r[0..3]', to: near, both: true, carries: [new_rays, completed_rays]}\n"
    "    - {from: 'r[4..5]', to: x, both: true, carries: [new_rays, completed_rays]}\n"
    "    - {from: x, to: far, both: true, carries: [new_rays, completed_rays], latency_cycles: 40}\n";

Json report_of(const Program& program, const std::string& file, const std::vector<std::string>& sets = {}) {
  std::vector<std::string> arguments{"run", file, "--json", "--force"};
  add_sets(arguments, sets);
  const Outcome run = program.run(arguments);
  EXPECT_EQ(run.status, 0) << testing::PrintToString(sets) << run.err;
  return run.status == 0 ? Json::parse(run.out) : Json::object();
}

TEST(DrawnPools, FindWhatOnePoolFindsInBothEngines) {
  const Program program;
  program.write("plain.yaml", kScene);
  program.write("pools.yaml", kScene + kPools);
  const Json plain = report_of(program, "plain.yaml");
  for (const std::vector<std::string>& sets : std::vector<std::vector<std::string>>{
           {"engine={kind: cycle, threads: 1, what_if: false}", "verify=reference"},
           {"engine={kind: cycle, threads: 3, what_if: false}", "collections.home=local"},
           {"engine={kind: cycle, threads: 1, what_if: false}", "image.max_depth=4",
            "shading.idle_resources_shade=true"},
           {"engine={kind: native, threads: 2}"}}) {
    const bool deep = sets.size() == 3;
    const Json report = report_of(program, "pools.yaml", sets);
    EXPECT_EQ(report["digest"],
              deep ? report_of(program, "plain.yaml", {"image.max_depth=4"})["digest"] : plain["digest"])
        << testing::PrintToString(sets);
    EXPECT_EQ(report["shading"]["workers"], 5);
  }
}

TEST(DrawnPools, TheReportHasEachPoolAndItsSums) {
  const Program program;
  program.write("pools.yaml",
                "report: {samples: 16}\nengine: {kind: cycle, threads: 1, what_if: false}\n" + kScene + kPools);
  const Json report = report_of(program, "pools.yaml");
  const Json& pools = report["shading"]["pools"];
  ASSERT_EQ(pools.size(), 2u);
  EXPECT_EQ(pools[0]["name"], "near");
  EXPECT_EQ(pools[1]["name"], "far");
  std::vector<double> sums(4);
  for (const Json& pool : pools) {
    sums[0] += pool["resources"].get<double>();
    sums[1] += pool["workers"].get<double>();
    sums[2] += pool["shaded"].get<double>();
    sums[3] += pool["utilisation"].get<double>() * pool["workers"].get<double>();
  }
  EXPECT_EQ(sums[0], 6);
  EXPECT_EQ(sums[1], report["shading"]["workers"]);
  EXPECT_EQ(sums[2], report["shading"]["shaded"]);
  EXPECT_NEAR(sums[3] / sums[1], report["shading"]["utilisation"].get<double>(), 1e-12);
  // Over time likewise.
  for (const char* quantity : {"rays completed", "shader workers busy", "rays waiting to be shaded"}) {
    std::vector<double> machine, both(report["time_series"]["samples"].get<std::size_t>());
    for (const Json& row : report["time_series"]["rows"]) {
      if (row["quantity"] != quantity) continue;
      const auto values = row["values"].get<std::vector<double>>();
      if (row["part"] == "machine") machine = values;
      for (std::size_t i = 0; (row["part"] == "pool 0" || row["part"] == "pool 1") && i < both.size(); ++i)
        both[i] += values[i];
    }
    ASSERT_EQ(machine.size(), both.size()) << quantity;
    for (std::size_t i = 0; i < both.size(); ++i) EXPECT_NEAR(machine[i], both[i], 1e-9) << quantity;
  }
}

TEST(DrawnPools, RowsOfLinksSayWhatTheyCarry) {
  const Program program;
  program.write("pools.yaml", "engine: {kind: cycle, threads: 1, what_if: false}\n" + kScene + kPools);
  const Json report = report_of(program, "pools.yaml");
  std::vector<std::string> between;
  std::size_t packets = 0;
  for (const Json& link : report["links"]) {
    const std::string carries = link["carries"];
    EXPECT_EQ(link["depth"] == 0, carries == "new_rays, completed_rays") << link;
    packets += carries == "packets";
    const Json& names = report["drawing"];
    if (names[link["from"].get<std::size_t>()]["name"] == "r[5]" && names[link["to"].get<std::size_t>()]["name"] == "x")
      between.push_back(carries);
  }
  EXPECT_EQ(packets, 7u);
  EXPECT_EQ(between, (std::vector<std::string>{"packets", "new_rays, completed_rays"}));
  program.write("ring.yaml", "engine: {kind: cycle, threads: 1, what_if: false}\n" + kScene);
  const Json ring = report_of(program, "ring.yaml");
  EXPECT_FALSE(ring["links"][0].contains("carries"));
}

TEST(DrawnPools, CheckAndPageNameThem) {
  const Program program;
  program.write("pools.yaml", "engine: {kind: cycle, threads: 1, what_if: false}\n" + kScene + kPools);
  const Outcome check = program.run({"check", "pools.yaml"});
  ASSERT_EQ(check.status, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("# parts: 0 caches, 0 memories, 2 shading, "));
  EXPECT_THAT(check.out,
              HasSubstr("# pools of workers: near shades the rays of r[0], r[1], r[2], r[3]; far of r[4], r[5]\n"));
  const Outcome json = program.run({"check", "pools.yaml", "--json"});
  EXPECT_EQ(Json::parse(json.out)["ignored_keys"], Json::array()) << json.out;
  const Outcome run = program.run({"run", "pools.yaml", "--out", "out", "--force"});
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string page = program.read("out/report.html");
  EXPECT_THAT(page, HasSubstr("Pools of shader workers"));
  EXPECT_THAT(page, HasSubstr("new_rays, completed_rays"));
}

// Both pools have area, and energy is that of all rays.
TEST(DrawnPools, AreaAndEnergyAreThoseOfAllWorkers) {
  const Program program;
  program.write("pools.yaml",
                "engine: {kind: cycle, threads: 1, what_if: false}\nenergy: {profile: n7}\n" + kScene + kPools);
  const Json five = report_of(program, "pools.yaml"),
             more = report_of(program, "pools.yaml", {"topology.nodes.3.workers=7"});
  const double area = five["area"]["parts"]["shaders"]["mm2"], grown = more["area"]["parts"]["shaders"]["mm2"];
  EXPECT_NEAR(grown / area, 2, 1e-9);
  EXPECT_EQ(five["energy"]["parts"]["shades"]["events"], five["shading"]["shaded"]);
}

}  // namespace
}  // namespace carousel::drawn_pools_test
