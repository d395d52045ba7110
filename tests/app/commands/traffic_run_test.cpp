#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/run/report_json.h"
#include "tests/app/support/program.h"
#include "tests/app/support/same_machine.h"
#include "tests/support/json_schema_check.h"
#include "tests/support/random_runs.h"

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

/// Shapes of some sizes with each pattern, rule and kind of queues.
std::vector<std::vector<std::string>> networks() {
  std::vector<std::vector<std::string>> out;
  std::size_t turn = 0;
  for (const char* pattern : {"uniform", "tornado", "neighbour", "hotspot", "bursty", "exchange"}) {
    const auto add = [&](std::vector<std::string> sets) {
      const bool even = std::string(pattern) == "exchange";
      const std::array sizes{even ? "8" : "7", even ? "6" : "1", even ? "2" : "3"};
      sets.push_back(std::string("topology.resources=") + sizes[turn++ % sizes.size()]);
      sets.push_back(std::string("workload.traffic.pattern=") + pattern);
      out.push_back(std::move(sets));
    };
    for (const char* shape : {"ring", "bidirectional", "multi_ring", "point_to_point"})
      for (const char* flow : {"credits", "bubble"})
        for (const char* queues : {"shared", "per_direction"})
          add({std::string("topology.shape=") + shape, std::string("topology.flow=") + flow,
               std::string("workload.traffic.source_queues=") + queues});
    for (const char* channels : {"dateline", "hops"})
      add({"topology.shape=hierarchical", "topology.groups=2", "topology.link.virtual_channels=16",
           std::string("topology.channels=") + channels});
  }
  return out;
}

TEST(TrafficRun, EveryShapeIsItsDrawingToTheLastNumber) {
  const Program program;
  const std::string traffic =
      "engine: {kind: cycle}\nworkload: {traffic: {rate: 0.5, packets: 2000, packet_bytes: 48}}\n";
  program.write("shape.yaml", traffic + "topology: {link: {depth: 3}, rings: 2}\n");
  std::size_t turn = 0;
  for (const std::vector<std::string>& sets : some(networks(), 12)) {
    SCOPED_TRACE(testing::PrintToString(sets));
    std::vector<std::string> arguments;
    for (const std::string& set : sets) arguments.insert(arguments.end(), {"--set", set});
    const auto run = [&](std::vector<std::string> command) {
      command.insert(command.end(), arguments.begin(), arguments.end());
      return program.run(command);
    };
    const std::string one = "shape" + std::to_string(turn), two = "graph" + std::to_string(turn++);
    const Outcome shape = run({"run", "shape.yaml", "--quiet", "--no-html", "--out", one}),
                  drawn = run({"check", "shape.yaml", "--graph"});
    ASSERT_EQ(shape.status, 0) << shape.err;
    ASSERT_EQ(drawn.status, 0) << drawn.err;
    EXPECT_EQ(drawn.out.find("visit:"), std::string::npos) << "synthetic traffic does not meet it";
    program.write("graph.yaml", traffic + drawn.out);
    std::erase_if(arguments, [](const std::string& set) { return set.starts_with("topology."); });
    std::erase(arguments, "--set");
    std::vector<std::string> command{"run", "graph.yaml", "--quiet", "--no-html", "--out", two};
    for (const std::string& set : arguments) command.insert(command.end(), {"--set", set});
    const Outcome graph = program.run(command);
    const bool other = drawn.out.starts_with("# Not the same machine: two resources of the shape");
    EXPECT_EQ(other, sets[0] == "topology.shape=point_to_point" && sets[3] == "topology.resources=2");
    ASSERT_EQ(graph.status, 0) << graph.err << drawn.out;
    if (!other) {
      EXPECT_EQ(results_of(program, one), results_of(program, two)) << drawn.out;
    }
  }
}

}  // namespace
}  // namespace carousel::traffic_run_test
