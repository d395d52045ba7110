#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/run/report_json.h"
#include "report/text/fit_lines.h"
#include "report/versus/versus.h"
#include "tests/app/support/program.h"
#include "tests/support/json_schema_check.h"

namespace carousel::versus_command_test {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

const char* const kRing =
    "scene: {builtin: terrain, triangles: 900}\nimage: {width: 16, height: 12, samples: 1, max_depth: 1}\n"
    "engine: {kind: cycle}\ntopology: {resources: 2}\nrays: {slots_per_resource: 64}\ncollections: {when_full: "
    "spill}\n";

TEST(VersusCommand, ComparesAMachineWithItsTwin) {
  const Program program;
  program.write("a.yaml", kRing);
  const Outcome outcome = program.run({"versus", "a.yaml", "--seeds", "2", "--out", "o"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json json = Json::parse(program.read("o/versus.json"));
  EXPECT_EQ(schema_problems(report::report_schema()["$defs"]["versus"], json), std::vector<std::string>{});
  ASSERT_EQ(json["lines"].size(), 5u);
  for (const Json& line : json["lines"]) EXPECT_THAT(outcome.out, HasSubstr(line.get<std::string>()));
  EXPECT_THAT(program.read("o/versus.html"), HasSubstr("conventional twin"));
  ASSERT_EQ(json["machines"].size(), 3u);
  EXPECT_EQ(json["machines"][1]["resources"], 2);
  EXPECT_TRUE(json["machines"][1].contains("lane_fill"));
  EXPECT_LE(json["machines"][2]["mm2"].get<double>(), json["machines"][0]["mm2"].get<double>());
  ASSERT_EQ(json["runs"].size(), 6u);
  for (std::size_t i = 2; i < 6; ++i) EXPECT_EQ(json["runs"][i]["hits"], json["runs"][i % 2]["hits"]);
  EXPECT_THAT(json["twin_sets"].dump(), HasSubstr("topology.shape=independent"));
  const Json& pair = json["against"][0];
  EXPECT_LT(pair["speed"]["low"].get<double>(), pair["speed"]["ratio"].get<double>());
  const bool slow = pair["speed"]["ratio"].get<double>() < 1;
  EXPECT_EQ(json["slower"], slow ? "machine" : "twin");
  EXPECT_GT(json["turns"].size(), 5u);
  for (std::size_t i = 1; i < json["turns"].size(); ++i)
    EXPECT_LE(json["turns"][i]["gain"].get<double>(), json["turns"][i - 1]["gain"].get<double>());
  // The page can be made again.
  EXPECT_EQ(program.run({"report", "o/versus.json", "--out", "again.html"}).status, 0);
  EXPECT_EQ(program.read("again.html"), program.read("o/versus.html"));
}

TEST(VersusCommand, RefusesWhatHasNoTwin) {
  const Program program;
  program.write("a.yaml", kRing);
  const auto error = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"versus", "a.yaml", "--out", "o"});
    const Outcome outcome = program.run(arguments);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_FALSE(std::filesystem::exists(program.folder() / "o/versus.json"));
    return outcome.err;
  };
  EXPECT_THAT(error({"--set", "engine.kind=native"}), HasSubstr("expected cycle, found native"));
  EXPECT_THAT(error({"--set", "workload=traffic"}), HasSubstr("expected rays"));
  EXPECT_THAT(error({"--set", "topology.shape=independent", "--set", "testers.simt.warp=32"}),
              HasSubstr("this machine is the conventional one itself"));
  EXPECT_THAT(error({"--seeds", "0"}), HasSubstr("--seeds"));
}

// Twins have warps, whose rays make rounds as well; a machine and its twin find the same hits and blend the same light.
TEST(VersusCommand, ComparesRaysThatLookForSeveralHits) {
  const std::string machine =
      "image: {width: 12, height: 8, samples: 1, max_depth: 1}\nengine: {kind: cycle}\ntopology: {resources: 2}\n"
      "collections: {traversal: ordered, when_full: spill}\n";
  const std::vector<std::string> texts{
      "scene: {builtin: instances, instances: 60}\nrays: {slots_per_resource: 64, query: {nearest: 8}}\n",
      "scene: {builtin: instances, instances: 60}\n"
      "rays: {slots_per_resource: 64, query: {nearest: 8, buffer: 3, rounds: resume}}\n",
      "scene: {builtin: gaussians, gaussians: {count: 150, degree: 2, geometry: triangles}}\n"
      "rays: {slots_per_resource: 64, query: {nearest: 200, buffer: 4}}\n",
      "scene: {builtin: gaussians, gaussians: {count: 150}}\n"
      "rays: {slots_per_resource: 64, query: {nearest: 200, buffer: 4, rounds: resume}}\n"};
  for (const std::string& text : texts) {
    const Program program;
    program.write("a.yaml", text + machine);
    const Outcome outcome = program.run({"versus", "a.yaml", "--seeds", "1", "--no-search", "--out", "o"});
    ASSERT_EQ(outcome.status, 0) << text << outcome.err;
    const Json json = Json::parse(program.read("o/versus.json"));
    ASSERT_GE(json["runs"].size(), 2u);
    EXPECT_NE(json["runs"][0]["nearest"], "");
    for (const Json& run : json["runs"])
      for (const char* digest : {"hits", "nearest", "image"}) EXPECT_EQ(run[digest], json["runs"][0][digest]) << text;
  }
}

// The last line of machines that are alike names no change that turns them round, since nothing is to be turned.
TEST(VersusLines, SayWhatTurnsItRound) {
  report::Versus v;
  v.slower = "twin";
  v.machines = {{.name = "machine"}, {.name = "twin"}};
  v.against = {{.than = "twin", .verdict = "faster"}};
  v.turns = {{"memory_bandwidth", "twice the memory", {}, 0.5, 1.25}, {"units", "more units", {}, 0.1, 1.1}};
  EXPECT_EQ(report::versus_lines(v).back(),
            "turned round by twice the memory: 1.250 times as fast as this machine then; so does one other");
  v.turns.pop_back();
  EXPECT_EQ(report::versus_lines(v).back(),
            "turned round by twice the memory: 1.250 times as fast as this machine then");
  v.turns.front().speed = 0.9;
  EXPECT_THAT(report::versus_lines(v).back(), HasSubstr("would turn it round; twice the memory brings it to 0.900"));
  v.against.front().verdict = "alike";
  EXPECT_EQ(report::versus_lines(v).back(),
            "nothing to turn round; with twice the memory the twin would be 0.900 times as fast as this machine");
}

TEST(VersusLines, AreFiveThatFitAScreen) {
  report::Versus v;
  v.seeds = 3;
  v.slower = "twin";
  const auto machine = [](const char* name, const char* limits) {
    report::VersusMachine out{.name = name, .limits = limits};
    out.rays_per_kilocycle = {605.64, 5.41}, out.memory_bytes_per_ray = {36.061, 1.02},
    out.nj_per_ray = {15.462, 0.281};
    out.reached = 0.991, out.resources = 16, out.mm2 = 24.791;
    return out;
  };
  v.machines = {machine("machine", "memory_bandwidth"), machine("twin", "memory_bandwidth"),
                machine("twin_at_equal_area", "shading")};
  const report::VersusRatio ratio{1.0114, 1.0101, 1.0123};
  v.against = {{.than = "twin", .verdict = "faster", .speed = ratio, .bytes = ratio, .joules = ratio},
               {.than = "twin_at_equal_area", .verdict = "faster", .speed = ratio, .bytes = ratio, .joules = ratio}};
  v.turns = {{"memory_bandwidth", "twice memory.dram_bytes_per_cycle", {}, 0.581, 1.564}};
  const std::vector<std::string> lines = report::versus_lines(v);
  EXPECT_EQ(lines.size(), 5u);
  for (const std::string& line : lines) EXPECT_LE(report::columns_of(line), 120u) << line;
}

// By hand: ratios 2 and 8 have the geometric mean 4; with two values t is 12.71 and the error of the mean half of
// ln 4 (W. S. Gosset, The probable error of a mean, 1908).
TEST(VersusRatio, IsOfPairs) {
  const report::VersusRatio two = report::versus_ratio({2, 16}, {1, 2});
  EXPECT_DOUBLE_EQ(two.ratio, 4);
  EXPECT_NEAR(*two.high / 4, std::exp(12.7062 * 0.693147), 20);
  EXPECT_NEAR(*two.low * *two.high, 16, 1e-9);
  const report::VersusRatio one = report::versus_ratio({3}, {2});
  EXPECT_DOUBLE_EQ(one.ratio, 1.5);
  EXPECT_FALSE(one.low);
  EXPECT_FALSE(one.surely_more());
  EXPECT_TRUE(report::versus_ratio({3, 3}, {2, 2}).surely_more());
  // On every host, with the series of core/numeric summed by hand; correct rounding ends in b.
  EXPECT_EQ(report::versus_ratio({5}, {3}).ratio, 0x1.aaaaaaaaaaaacp+0);
}

TEST(VersusLines, HaveOneOfAThingInTheSingularAndWideIntervalsByTheirEnds) {
  report::Versus v;
  v.seeds = 1;
  v.machines = {{.name = "machine", .resources = 4},
                {.name = "twin", .resources = 4},
                {.name = "twin_at_equal_area", .resources = 1, .mm2 = 2}};
  v.against = {{.than = "twin", .verdict = "alike", .speed = {0.8, 0.25, 3.125}},
               {.than = "twin_at_equal_area", .verdict = "faster", .speed = {2, 1.5, 2.5}}};
  const std::vector<std::string> lines = report::versus_lines(v);
  EXPECT_THAT(lines[0], HasSubstr("alike: 0.800 (0.25 to 3.125) times as fast"));
  EXPECT_THAT(lines[0], HasSubstr(", 1 seed"));
  EXPECT_THAT(lines[2], HasSubstr("2.000 ± 0.500 times as fast: the twin has 1 resource in 2 mm2"));
}

TEST(VersusCommand, IsUnsureOfOneSeed) {
  const Program program;
  program.write("a.yaml", kRing);
  const Outcome outcome = program.run({"versus", "a.yaml", "--seeds", "1", "--no-search", "--out", "o"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("unsure: "));
  EXPECT_EQ(Json::parse(program.read("o/versus.json"))["against"][0]["verdict"], "unsure");
}

// Everything that has a key is charged on both sides.
TEST(VersusCommand, ChargesBothMachines) {
  const Program program;
  program.write("a.yaml", kRing);
  const auto json = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"versus", "a.yaml", "--seeds", "1", "--no-search", "--force", "--out", "o"});
    const Outcome outcome = program.run(more);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return Json::parse(program.read("o/versus.json"));
  };
  const Json base = json({}), all = json({"--charge-all"});
  ASSERT_EQ(base["runs"].size(), all["runs"].size());
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_GT(all["runs"][i]["cycles"], base["runs"][i]["cycles"]) << i;
    EXPECT_EQ(all["runs"][i]["image"], base["runs"][i]["image"]);
  }
  EXPECT_THAT(program.read("o/config.resolved.yaml"), HasSubstr("film: memory"));
  EXPECT_THAT(all["twin_sets"].dump(), testing::Not(HasSubstr("memory.film")));
}

}  // namespace
}  // namespace carousel::versus_command_test
