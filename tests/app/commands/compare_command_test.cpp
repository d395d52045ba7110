#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel::compare_command_test {
namespace {

using testing::HasSubstr;

constexpr const char* kConfig =
    "scene: {builtin: cornell}\nimage: {width: 24, height: 24, samples: 1, max_depth: 2}\n"
    "engine: {kind: cycle, what_if: false}\ntopology: {resources: 4}\nrays: {slots_per_resource: 64}\n";

std::string run_into(const Program& program, const std::string& out, const std::vector<std::string>& sets = {}) {
  std::vector<std::string> arguments{"run", "a.yaml", "--quiet", "--out", out};
  add_sets(arguments, sets);
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
  const Outcome outcome = program.run({"compare", a + "/report.json", b, "--all"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("topology.link.latency_cycles"));
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
  Outcome refused = program.run({"compare", a, "changed.json"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("changed.json: checksum: expected "));
  report.erase("checksum");
  program.write("changed.json", report.dump());
  const Outcome outcome = program.run({"compare", a, "changed.json"});
  EXPECT_THAT(outcome.out, HasSubstr("engine.epochs.digests.0"));
  EXPECT_THAT(outcome.out, HasSubstr("one of the reports was written by another program"));
}

TEST(CompareCommand, ShowsTwoMachinesSideBySide) {
  const Program program;
  program.write("a.yaml", kConfig);
  const std::string a = run_into(program, "one"), b = run_into(program, "two", {"topology.resources=2"}),
                    c = run_into(program, "three", {"image.seed=2"});
  const auto cycles = [&](const std::string& folder) {
    return nlohmann::json::parse(program.read(folder + "/report.json"))["engine"]["cycles"].get<double>();
  };
  const Outcome outcome = program.run({"compare", a, b, c});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("A  one\nB  two\nC  three\n\nhits           different: C from A\n"
                                     "picture        different: C from A\nconfiguration  2 keys differ\n"));
  EXPECT_THAT(outcome.out, HasSubstr("topology.resources  4  2  4\n"));
  EXPECT_THAT(outcome.out, HasSubstr("image.seed          1  1  2\n"));
  for (const char* title : {"throughput", "cycles of the test units", "bytes", "memory"})
    EXPECT_THAT(outcome.out, HasSubstr(std::string("\n") + title));
  EXPECT_THAT(outcome.out, testing::Not(HasSubstr("resources.0.")));
  EXPECT_THAT(outcome.out, HasSubstr("more values differ (--all, or --only PATTERN, lists them)"));

  const auto json = nlohmann::json::parse(program.run({"compare", a, b, c, "--json"}).out);
  EXPECT_EQ(json["same_hits"], nlohmann::json({true, true, false}));
  const auto& rows = json["sections"][0]["rows"];
  EXPECT_EQ(json["sections"][0]["name"], "throughput");
  bool found = false;
  for (const auto& row : rows) {
    if (row["name"] != "length") continue;
    found = true;
    EXPECT_EQ(row["values"][1], cycles(b));
    EXPECT_DOUBLE_EQ(row["ratios"][1], cycles(b) / cycles(a));
  }
  EXPECT_TRUE(found);
  for (const auto& section : json["sections"]) {  // a ledger of cycles adds up to the whole
    if (section["name"] != "cycles of the test units") continue;
    double box = 0;
    for (const auto& row : section["rows"])
      if (row["name"].get<std::string>().starts_with("box ")) box += row["values"][0].get<double>();
    EXPECT_NEAR(box, 1, 1e-9);
  }
}

TEST(CompareCommand, WritesAPage) {
  const Program program;
  program.write("a.yaml", kConfig);
  const std::string a = run_into(program, "one"), b = run_into(program, "two", {"topology.resources=2"});
  const Outcome outcome = program.run({"compare", a, b, "--html", "pages/both.html"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("topology.resources")) << "the terminal has its table as well";
  const std::string page = program.read("pages/both.html");
  for (const char* part : {"Hits are the same in all runs", "id=\"table-section-0\"", "data-chart=\"ratios\"",
                           "data-chart=\"shares\"", "topology.resources", "more values differ"})
    EXPECT_THAT(page, HasSubstr(part));
  EXPECT_EQ(program.run({"compare", a, b, "--html", "one"}).status, 2);
}

TEST(CompareCommand, OnlyKeepsWhatAPatternNames) {
  const Program program;
  program.write("a.yaml", kConfig);
  const std::string a = run_into(program, "one"), b = run_into(program, "two", {"topology.resources=2"});
  const std::string text = program.run({"compare", a, b, "--only", "PACK*issued"}).out;
  EXPECT_THAT(text, HasSubstr("packets.issued"));
  EXPECT_THAT(text, testing::Not(HasSubstr("whole run")));
  EXPECT_THAT(text, testing::Not(HasSubstr("topology.resources")));
}

TEST(CompareCommand, SaysThatNativeRunsOfOneConfigurationAreTheSame) {
  const Program program;
  program.write("a.yaml", kConfig);
  const std::string a = run_into(program, "one", {"engine.kind=native"}),
                    b = run_into(program, "two", {"engine.kind=native"});
  const Outcome outcome = program.run({"compare", a, b});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  if (outcome.out == "identical\n") return;  // the threads kept the same time
  EXPECT_THAT(outcome.out,
              HasSubstr("hits           the same\npicture        the same\nconfiguration  the same: these are "
                        "runs of one configuration with the same result"));
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
  run_into(program, "slow",
           {"engine.what_if=true", "rays.slots_per_resource=32", "image.width=48", "image.height=48",
            "shading.workers=1", "shading.cycles_per_shade=500"});
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
}  // namespace carousel::compare_command_test
