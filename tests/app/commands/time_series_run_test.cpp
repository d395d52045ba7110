// The time series in report.json, as `carousel run` writes it.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/run/report_json.h"
#include "tests/app/support/program.h"
#include "tests/support/json_schema_check.h"

namespace carousel::time_series_run_test {
namespace {

using Json = nlohmann::ordered_json;

const char* const kSmall =
    "scene: {builtin: cornell}\nimage: {width: 24, height: 16, samples: 2}\nengine: {threads: 2, what_if: false}\n"
    "topology: {resources: 3}\nrays: {slots_per_resource: 64}\n";

const Json* row_of(const Json& series, const std::string& part, const std::string& quantity) {
  for (const Json& row : series["rows"])
    if (row["part"] == part && row["quantity"] == quantity) return &row;
  return nullptr;
}

double sum_of(const Json& row) {
  double sum = 0;
  for (const Json& value : row["values"]) sum += value.get<double>();
  return sum;
}

TEST(TimeSeriesRun, OfTheCycleEngineIsInCyclesAndBounded) {
  const Program program;
  program.write("small.yaml", kSmall);
  ASSERT_EQ(program.run({"run", "small.yaml", "--set", "engine.kind=cycle", "--set", "report.samples=32"}).status, 0);
  const std::string text = program.read("out/small/report.json");
  const Json report = Json::parse(text);
  EXPECT_EQ(schema_problems(report::report_schema(), report), std::vector<std::string>{});
  EXPECT_FALSE(report["host"].contains("time_series"));
  const Json& series = report["time_series"];
  EXPECT_EQ(series["unit"], "cycles");
  const std::size_t samples = series["samples"];
  EXPECT_LE(samples, 32u);
  EXPECT_GT(samples, 14u);
  EXPECT_GE(series["interval"].get<double>() * static_cast<double>(samples), report["engine"]["cycles"].get<double>());
  EXPECT_EQ(series["rows"][0]["part"], "machine");
  for (const Json& row : series["rows"]) EXPECT_EQ(row["values"].size(), samples);
  const Json* completed = row_of(series, "machine", "rays completed");
  ASSERT_NE(completed, nullptr);
  EXPECT_EQ(sum_of(*completed), report["rays"]["completed"].get<double>());
  for (std::size_t l = 0; l < report["links"].size(); ++l) {
    const Json* bytes = row_of(series, "link " + std::to_string(l), "bytes");
    ASSERT_NE(bytes, nullptr);
    EXPECT_EQ(sum_of(*bytes), report["links"][l]["bytes"].get<double>());
  }
  const Json* box = row_of(series, "resource 1", "box busy");
  ASSERT_NE(box, nullptr);
  EXPECT_EQ(sum_of(*box) * series["interval"].get<double>(),
            report["resources"][1]["units"]["box"]["busy"].get<double>());
  // A row stands on one line, and rows of zeros are left out.
  EXPECT_NE(text.find("\"values\": [0"), std::string::npos);
  EXPECT_EQ(row_of(series, "resource 1", "plane busy"), nullptr);
}

TEST(TimeSeriesRun, OfTheNativeEngineIsInSecondsOfTheHost) {
  const Program program;
  program.write("small.yaml", kSmall);
  ASSERT_EQ(program.run({"run", "small.yaml", "--set", "image.samples=10"}).status, 0);
  const Json report = Json::parse(program.read("out/small/report.json"));
  EXPECT_EQ(schema_problems(report::report_schema(), report), std::vector<std::string>{});
  EXPECT_FALSE(report.contains("time_series"));
  const Json& series = report["host"]["time_series"];
  EXPECT_EQ(series["unit"], "seconds");
  EXPECT_LE(series["samples"].get<std::size_t>(), 256u);
  EXPECT_GE(series["interval"].get<double>() * series["samples"].get<double>(),
            report["host"]["wall_seconds"].get<double>());
  const Json* completed = row_of(series, "machine", "rays completed");
  ASSERT_NE(completed, nullptr);
  EXPECT_EQ(sum_of(*completed), report["rays"]["completed"].get<double>());
  for (int r = 0; r < 3; ++r) {
    const Json* visits = row_of(series, "resource " + std::to_string(r), "visits");
    ASSERT_NE(visits, nullptr);
    EXPECT_GT(sum_of(*visits), 0);
  }
}

}  // namespace
}  // namespace carousel::time_series_run_test
