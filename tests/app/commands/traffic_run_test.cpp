#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/run/report_json.h"
#include "tests/app/support/program.h"
#include "tests/support/json_schema_check.h"

namespace carousel::traffic_run_test {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

const char* const kTraffic =
    "engine: {kind: cycle}\ntopology: {shape: bidirectional}\nworkload: {traffic: {pattern: uniform, rate: 0.1, "
    "packets: 20000}}\n";

TEST(TrafficRun, NeedsNoSceneAndLeavesAReport) {
  const Program program;
  program.write("net.yaml", kTraffic);
  const Outcome outcome = program.run({"run", "net.yaml"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("cycle: uniform traffic on 8 resources, bidirectional"));
  EXPECT_THAT(outcome.out, HasSubstr("20,000 created   20,000 delivered"));
  EXPECT_THAT(outcome.out, HasSubstr("files        out/net\n"));
  const Json report = Json::parse(program.read("out/net/report.json"));
  EXPECT_EQ(schema_problems(report::report_schema(), report), std::vector<std::string>{});
  EXPECT_EQ(report["traffic"]["delivered"], 20000);
  EXPECT_EQ(report["links"].size(), 16u);
  EXPECT_EQ(report["engine"]["deterministic"], true);
  EXPECT_NEAR(report["traffic"]["accepted"].get<double>(), 0.1, 0.005);

  // The resolved configuration gives the same, on any number of threads.
  ASSERT_EQ(
      program.run({"run", "out/net/config.resolved.yaml", "--out", "b", "--set", "engine.threads=3", "--quiet"}).status,
      0);
  Json again = Json::parse(program.read("b/report.json"));
  EXPECT_EQ(again["host"]["threads"], 3);
  EXPECT_EQ(again["traffic"], report["traffic"]);
  EXPECT_EQ(again["links"], report["links"]);
}

TEST(TrafficRun, ASetKeyTakesEffect) {
  const Program program;
  program.write("net.yaml", kTraffic);
  const Outcome outcome = program.run({"run", "net.yaml", "--json", "--set", "workload.traffic.pattern=neighbour",
                                       "--set", "workload.traffic.rate=0.02", "--set",
                                       "workload.traffic.inject_cycles=3", "--set", "workload.traffic.eject_cycles=3"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json report = Json::parse(outcome.out);
  EXPECT_EQ(report["traffic"]["latency"]["mean"], 10.0);
  EXPECT_EQ(report["traffic"]["routers_mean"], 2.0);
}

TEST(TrafficRun, CheckKnowsItAndNativeIsRefused) {
  const Program program;
  program.write("net.yaml", kTraffic);
  const Outcome check = program.run({"check", "net.yaml"});
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("# scene: none, synthetic traffic"));
  const Outcome native = program.run({"run", "net.yaml", "--set", "engine.kind=native"});
  EXPECT_EQ(native.status, 2);
  EXPECT_THAT(native.err, HasSubstr("workload: traffic runs in virtual time"));
}

TEST(TrafficRun, HasNoHitsToWrite) {
  const Program program;
  program.write("net.yaml", kTraffic);
  for (const std::vector<std::string>& option : {std::vector<std::string>{"--hits"}, {"--dump-rays", "rays.csv"}}) {
    std::vector<std::string> arguments{"run", "net.yaml", "--force"};
    arguments.insert(arguments.end(), option.begin(), option.end());
    const Outcome outcome = program.run(arguments);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr(option[0] + ": synthetic traffic has no rays"));
  }
}

}  // namespace
}  // namespace carousel::traffic_run_test
