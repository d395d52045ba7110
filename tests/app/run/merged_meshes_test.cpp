// The report and the terminal name the number of meshes with one structure, and the hits stay.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel::merged_meshes_run_test {
namespace {

using Json = nlohmann::ordered_json;

struct Result {
  Json report;
  std::string out;
};

Result run_with(const Program& program, const std::string& merge) {
  program.write("machine.yaml",
                "scene: {builtin: spheres, triangles: 2000}\n"
                "image: {width: 24, height: 16, samples: 1, max_depth: 2}\n"
                "bvh: {merge: " +
                    merge + "}\n");
  const Outcome outcome = program.run({"run", "machine.yaml", "--out", merge});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return {Json::parse(program.read(merge + "/report.json")), outcome.out};
}

TEST(MergedMeshesRun, AreCountedInReportAndTable) {
  const Program program;
  const Result apart = run_with(program, "none"), merged = run_with(program, "world");
  EXPECT_EQ(apart.report["structure"]["merged_meshes"], 0);
  EXPECT_GE(merged.report["structure"]["merged_meshes"], 2);
  EXPECT_EQ(merged.report["structure"]["primitives"], apart.report["structure"]["primitives"]);
  EXPECT_THAT(merged.out, testing::HasSubstr("meshes of the world in one"));
  EXPECT_THAT(apart.out, testing::Not(testing::HasSubstr("meshes of the world in one")));
  EXPECT_EQ(merged.report["digest"]["hits"], apart.report["digest"]["hits"]);
}

}  // namespace
}  // namespace carousel::merged_meshes_run_test
