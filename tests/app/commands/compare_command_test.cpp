#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel {
namespace {

using testing::HasSubstr;

constexpr const char* kConfig =
    "scene: {builtin: cornell}\nimage: {width: 24, height: 24, samples: 1, max_depth: 2}\n"
    "engine: {kind: cycle, what_if: false}\ntopology: {resources: 4}\nrays: {slots_per_resource: 64}\n";

std::string run_into(const Program& program, const std::string& out, const std::vector<std::string>& sets = {}) {
  std::vector<std::string> arguments{"run", "a.yaml", "--quiet", "--out", out};
  for (const std::string& set : sets) arguments.insert(arguments.end(), {"--set", set});
  const Outcome outcome = program.run(arguments);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return out;
}

TEST(CompareCommand, RunsOfOneConfigAreIdenticalForAnyNumberOfThreads) {
  const Program program;
  program.write("a.yaml", kConfig);
  const std::string one = run_into(program, "one", {"engine.threads=1"});
  for (const char* threads : {"2", "3", "8"}) {
    const std::string other = run_into(program, "other", {std::string("engine.threads=") + threads});
    const Outcome outcome = program.run({"compare", one, other, "--expect", "identical"});
    EXPECT_EQ(outcome.status, 0) << outcome.out;
    EXPECT_EQ(outcome.out, "identical\n");
  }
}

TEST(CompareCommand, NamesTheFirstDivergence) {
  const Program program;
  program.write("a.yaml", kConfig);
  const std::string a = run_into(program, "one"), b = run_into(program, "two", {"topology.link.latency_cycles=5"});
  const Outcome outcome = program.run({"compare", a + "/report.json", b});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("config.topology.link.latency_cycles"));
  EXPECT_THAT(outcome.out, HasSubstr("first differing epoch: cycles 0 to 4095"));
  EXPECT_THAT(outcome.out, HasSubstr("first divergence\n  A: cycle "));
  EXPECT_EQ(program.run({"compare", a, b, "--expect", "identical"}).status, 1);
}

TEST(CompareCommand, SaysWhenAReportIsAnotherProgramsWork) {
  const Program program;
  program.write("a.yaml", kConfig);
  const std::string a = run_into(program, "one");
  nlohmann::ordered_json report = nlohmann::ordered_json::parse(program.read("one/report.json"));
  report["engine"]["epochs"]["digests"][0] = "0123456789abcdef";
  program.write("changed.json", report.dump());
  const Outcome outcome = program.run({"compare", a, "changed.json"});
  EXPECT_THAT(outcome.out, HasSubstr("engine.epochs.digests.0"));
  EXPECT_THAT(outcome.out, HasSubstr("one of the reports was written by another program"));
}

TEST(CompareCommand, RefusesWhatIsNoReport) {
  const Program program;
  program.write("a.json", "{}");
  EXPECT_EQ(program.run({"compare", "a.json", "missing.json"}).status, 2);
  EXPECT_EQ(program.run({"compare", "a.json"}).status, 2);
  EXPECT_EQ(program.run({"compare", "a.json", "a.json", "--expect", "luck"}).status, 2);
}

TEST(CycleRun, GivesTheNativePicture) {
  const Program program;
  program.write("a.yaml", kConfig);
  const auto digest = [&](const std::string& folder) {
    return nlohmann::json::parse(program.read(folder + "/report.json"))["digest"];
  };
  const std::string cycle = run_into(program, "cycle"), native = run_into(program, "native", {"engine.kind=native"});
  EXPECT_EQ(digest(cycle), digest(native));
}

TEST(CycleRun, NamesWhatLimitsTheMachine) {
  const Program program;
  program.write("a.yaml", kConfig);
  run_into(program, "slow", {"engine.what_if=true", "shading.workers=1", "shading.cycles_per_shade=500"});
  const auto report = nlohmann::json::parse(program.read("slow/report.json"));
  EXPECT_EQ(report["bottleneck"]["limits"], "shading");
  EXPECT_EQ(report["bound"]["classes"][0]["name"], "shading");
  EXPECT_GT(report["bottleneck"]["gains"][0]["gain"], 0.8);
}

TEST(CycleRun, EndsWithStatusOneWhenItIsStuck) {
  const Program program;
  program.write("a.yaml",
                std::string(kConfig) +
                    "packets: {rays: 2}\ncollections: {ready: 2, when_full: spill}\nmemory: {fetch_ahead: 16}\n"
                    "testers: {contexts: 1}\n");
  const std::vector<std::string> stuck{
      "run", "a.yaml", "--quiet", "--set", "topology.flow=none", "--set", "topology.link.depth=1"};
  EXPECT_EQ(program.run(stuck).status, 2);  // refused unless forced
  std::vector<std::string> forced = stuck;
  forced.push_back("--force");
  const Outcome outcome = program.run(forced);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("a circle of waits: resource "));
}

}  // namespace
}  // namespace carousel
