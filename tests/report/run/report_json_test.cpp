#include "report/run/report_json.h"

#include <gtest/gtest.h>

#include "tests/report/run/sample_report.h"
#include "tests/support/json_schema_check.h"

namespace carousel::report {
namespace {

using Json = nlohmann::ordered_json;

TEST(ReportJson, HasTheKeysOfTheContract) {
  const Json json = report_json(sample_report());
  for (const char* key : {"schema_version", "carousel", "config", "scene", "engine", "rays", "throughput", "tests",
                          "packets", "collections", "resources", "links", "shading", "verify", "digest", "host"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["rays"]["by_kind"]["bounce"], 300);
  EXPECT_EQ(json["tests"]["triangle"]["per_ray"], 2.25);
  EXPECT_EQ(json["links"][1]["occupancy_max"], 11);
  EXPECT_EQ(json["cull_planes"]["levels"][0]["structure"], "top");
  EXPECT_EQ(json["cull_planes"]["levels"][0]["culled"], 40);
  EXPECT_EQ(json["cull_planes"]["levels"][1]["structure"], "bottom");
  EXPECT_EQ(json["cull_planes"]["levels"][1]["depth"], 3);
  EXPECT_EQ(json["cull_planes"]["levels"][1]["triangle_tests_spared"], 605);
  EXPECT_EQ(json["host"]["plane_seconds"], 0.125);
  EXPECT_EQ(json["host"]["raster_seconds"], 0.25);
  EXPECT_EQ(json["raster"]["left_to_rays"], 3);
  EXPECT_EQ(json["digest"]["image"], "4567");
  EXPECT_EQ(json["scene"]["bounds"]["lo"], Json({-1.0, -2.0, -3.0}));
}

TEST(ReportJson, LeavesOutWhatIsAbsent) {
  Report report = sample_report();
  report.verify.reset();
  report.tests.reset();
  report.digest.image.reset();
  const Json json = report_json(report);
  EXPECT_FALSE(json.contains("verify"));
  EXPECT_FALSE(json.contains("tests"));
  EXPECT_FALSE(json["digest"].contains("image"));
}

TEST(ReportJson, TheSchemaAcceptsReports) {
  EXPECT_EQ(schema_problems(report_schema(), report_json(sample_report())), std::vector<std::string>{});
  EXPECT_EQ(schema_problems(report_schema(), report_json(Report{})), std::vector<std::string>{});
}

TEST(ReportJson, TheSchemaRefusesMissingAndUnknownKeys) {
  Json json = report_json(sample_report());
  json["rays"].erase("lost");
  EXPECT_FALSE(schema_problems(report_schema(), json).empty());
  json = report_json(sample_report());
  json["rays"]["found"] = 1;
  EXPECT_FALSE(schema_problems(report_schema(), json).empty());
  json = report_json(sample_report());
  json["rays"]["lost"] = -1;
  EXPECT_FALSE(schema_problems(report_schema(), json).empty());
}

/// Every number has a unit in its schema entry or is one of the few that need none.
void expect_units(const Json& schema, const std::string& path) {
  if (schema.contains("properties"))
    for (const auto& [key, value] : schema["properties"].items()) {
      const std::string child = path + "." + key;
      EXPECT_TRUE(value.contains("description")) << child;
      const bool number = value["type"] == "integer" || value["type"] == "number";
      const bool plain = key.ends_with("fraction") || key == "fullness_mean" || key == "resource" || key == "from" ||
                         key == "to" || key == "schema_version" || key == "rank" || key == "first_resource";
      EXPECT_TRUE(!number || plain || value.contains("unit")) << child;
      expect_units(value, child);
    }
  if (schema.contains("items")) expect_units(schema["items"], path);
}

TEST(ReportJson, EveryCountHasAUnit) {
  expect_units(report_schema(), "");
}

// The rows of packet processes that serve resources are the last; those with cells of their own have units.
TEST(ReportJson, KnowsWhichResourcesHaveUnits) {
  const auto config = nlohmann::ordered_json::parse(R"({"topology": {"shape": "graph", "nodes": [
    {"kind": "resource", "count": 4}, {"kind": "cache", "count": "auto", "serves": "r[*]"},
    {"kind": "packet_process", "count": 2, "serves": "r[0..1]"},
    {"kind": "packet_process", "count": "auto", "serves": "r[2..3]"}]}})");
  EXPECT_EQ(resources_with_units(config, 7), 4u);
  auto cells = config;
  for (auto& node : cells["topology"]["nodes"]) node.erase("serves");
  EXPECT_EQ(resources_with_units(cells, 7), 7u);
  EXPECT_EQ(resources_with_units({}, 7), 7u);
}

}  // namespace
}  // namespace carousel::report
