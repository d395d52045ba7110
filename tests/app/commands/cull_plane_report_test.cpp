// The report of a run with cull planes.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/run/report_json.h"
#include "tests/app/support/program.h"
#include "tests/support/json_schema_check.h"

namespace carousel::cull_plane_report_test {
namespace {

using Json = nlohmann::ordered_json;

const char* const kInstances =
    "scene: {builtin: instances, instances: 60}\nimage: {width: 24, height: 24, samples: 1}\n"
    "engine: {threads: 1}\ntopology: {resources: 3}\ncull_planes: {count: 4, nodes: all, levels: all}\n";

Json reported(const Program& program, const std::vector<std::string>& sets) {
  std::vector<std::string> arguments{"run", "planes.yaml", "--json", "--quiet", "--force"};
  add_sets(arguments, sets);
  const Outcome outcome = program.run(arguments);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return Json::parse(outcome.out);
}

TEST(CullPlaneReport, AddsUpByDepthInBothEngines) {
  const Program program;
  program.write("planes.yaml", kInstances);
  for (const char* engine : {"engine.kind=native", "engine.kind=cycle"})
    for (const char* order : {"cull_planes.order=box_first", "cull_planes.order=planes_first"}) {
      const Json report = reported(program, {engine, order, "engine.what_if=false", "verify=reference"});
      EXPECT_EQ(schema_problems(report::report_schema(), report), std::vector<std::string>{});
      std::uint64_t culled = 0, plane_tests = 0, boxes = 0, transforms = 0;
      for (const Json& level : report["cull_planes"]["levels"]) {
        culled += level["culled"].get<std::uint64_t>();
        plane_tests += level["plane_tests"].get<std::uint64_t>();
        boxes += level["box_tests_spared"].get<std::uint64_t>();
        transforms += level["transforms_spared"].get<std::uint64_t>();
        EXPECT_TRUE(level["structure"] == "top" || level["transforms_spared"] == 0);
      }
      EXPECT_EQ(report["verify"]["mismatches"], 0);
      EXPECT_EQ(culled, report["tests"]["culled"]["count"]);
      EXPECT_EQ(plane_tests, report["tests"]["plane"]["count"]);
      EXPECT_GT(transforms, 0u);
      EXPECT_EQ(boxes > 0, order == std::string("cull_planes.order=planes_first"));
      EXPECT_EQ(report["cull_planes"]["bytes"], 16 * report["cull_planes"]["planes"].get<std::uint64_t>());
      EXPECT_TRUE(report["host"].contains("plane_seconds"));
    }
}

TEST(CullPlaneReport, IsLeftOutWithoutPlanes) {
  const Program program;
  program.write("planes.yaml", kInstances);
  const Json with = reported(program, {}), without = reported(program, {"cull_planes.count=0"});
  EXPECT_FALSE(without.contains("cull_planes"));
  EXPECT_FALSE(without["host"].contains("plane_seconds"));
  EXPECT_EQ(with["digest"], without["digest"]);
  EXPECT_LT(with["tests"]["transforms"]["count"], without["tests"]["transforms"]["count"]);
}

}  // namespace
}  // namespace carousel::cull_plane_report_test
