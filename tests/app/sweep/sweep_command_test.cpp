// carousel sweep as a user runs it: points, their results, errors, shards.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/sweep/sweep_program.h"

namespace carousel::sweep_command_test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class SweepCommand : public testing::Test {
 protected:
  SweepCommand() { program_.write("a.yaml", kTinyMachine); }
  Outcome sweep(std::vector<std::string> more) const { return program_.run(sweep_words(std::move(more))); }
  Json results(const std::string& folder = "out/a") const { return Json::parse(program_.read(folder + "/sweep.json")); }

  Program program_;
};

TEST_F(SweepCommand, EachPointIsTheRunOfItsKeys) {
  const std::vector<std::string> more{
      "--vary",  "topology.resources=2,4", "--vary",  "topology.shape,memory.l2_kib=(ring,64),(bidirectional,512)",
      "--scene", "builtin:cornell",        "--scene", "builtin:sliver",
      "--set",   "scene.triangles=500"};
  const Outcome outcome = sweep(more);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json all = results();
  ASSERT_EQ(all["points"].size(), 8u);
  for (const Json& point : all["points"]) {
    if (point["keys"]["topology.resources"] == 2 && point["keys"]["topology.shape"] == "ring") continue;
    std::vector<std::string> run{"run", "a.yaml", "--quiet", "--out", "one", "--set"};
    run.push_back("scene={builtin: " + point["keys"]["scene"].get<std::string>().substr(8) + "}");
    run.insert(run.end(), {"--set", "scene.triangles=500"});
    for (const char* key : {"topology.resources", "topology.shape", "memory.l2_kib"}) {
      const Json& value = point["keys"][key];
      run.insert(run.end(),
                 {"--set", std::string(key) + "=" + (value.is_string() ? value.get<std::string>() : value.dump())});
    }
    std::filesystem::remove_all(program_.folder() / "one");
    ASSERT_EQ(program_.run(run).status, 0);
    Json alone = Json::parse(program_.read("one/report.json"));
    Json swept = Json::parse(program_.read("out/a/points/" + point["point"].get<std::string>() + ".json"))["report"];
    alone.erase("host");
    alone.erase("checksum");
    swept.erase("host");
    EXPECT_EQ(alone, swept) << point["keys"];
    EXPECT_EQ(point["results"]["cycles"], alone["engine"]["cycles"]);
  }
}

TEST_F(SweepCommand, TakesVaryOfTheConfigurationAndRepeats) {
  program_.write("a.yaml",
                 std::string(kTinyMachine) + "vary: {memory.l2_kib: [64, 128], 'topology.resources': 2..4*2}\n");
  Outcome outcome = sweep({"--repeat", "2", "--vary", "memory.l2_kib=256", "--result", "packets.latency.p99"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json all = results();
  ASSERT_EQ(all["points"].size(), 4u) << "the command line replaces the values of the file";
  for (const Json& point : all["points"]) {
    EXPECT_EQ(point["keys"]["memory.l2_kib"], 256);
    EXPECT_TRUE(point["results"]["packets.latency.p99"].is_number());
  }
  EXPECT_NE(all["points"][0]["keys"]["image.seed"], all["points"][1]["keys"]["image.seed"]);
  const std::string csv = program_.read("out/a/sweep.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
  EXPECT_THAT(csv, HasSubstr("point,status,topology.resources,memory.l2_kib,image.seed,cycles,"));
}

TEST_F(SweepCommand, RunsNoPointTwiceAndNewOnesForAChangedConfiguration) {
  ASSERT_EQ(sweep({"--vary", "topology.resources=2,4"}).status, 0);
  const auto before =
      std::filesystem::last_write_time(*std::filesystem::directory_iterator(program_.folder() / "out/a/points"));
  ASSERT_EQ(sweep({"--vary", "topology.resources=2,4,8"}).status, 0);
  EXPECT_EQ(points_of(program_.folder() / "out/a").size(), 3u);
  bool kept = false;
  for (const auto& entry : std::filesystem::directory_iterator(program_.folder() / "out/a/points"))
    kept |= entry.last_write_time() == before;
  EXPECT_TRUE(kept);
  ASSERT_EQ(sweep({"--vary", "topology.resources=2,4", "--set", "image.seed=9"}).status, 0);
  EXPECT_EQ(points_of(program_.folder() / "out/a").size(), 5u);
}

TEST_F(SweepCommand, RefusesInvalidPointsBeforeAnythingRuns) {
  const std::vector<std::string> more{"--vary", "topology.shape=ring,bus", "--vary", "engine.kind=native,cycle"};
  const Outcome refused = sweep(more);
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("at the point topology.shape=bus, engine.kind=native"));
  EXPECT_FALSE(std::filesystem::exists(program_.folder() / "out"));
  std::vector<std::string> fewer = more;
  fewer.insert(fewer.end(), {"--exclude", "topology.shape=bus,engine.kind=native"});
  EXPECT_EQ(sweep(fewer).status, 0);
  EXPECT_EQ(results()["points"].size(), 3u);
}

TEST_F(SweepCommand, KeepsFailedPointsUntilTheyAreToBeRetried) {
  program_.write("bad.gltf", "{}");
  const std::vector<std::string> more{"--scene", "builtin:cornell", "--scene", "bad.gltf"};
  const Outcome outcome = sweep(more);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("the point scene=bad.gltf failed: scene: "));
  Json point = results()["points"][1];
  EXPECT_EQ(point["status"], "failed");
  EXPECT_EQ(point["error"]["kind"], "scene");
  const auto file = program_.folder() / "out/a/points" / (point["point"].get<std::string>() + ".json");
  const auto before = std::filesystem::last_write_time(file);
  EXPECT_EQ(sweep(more).status, 1);
  EXPECT_EQ(std::filesystem::last_write_time(file), before) << "it ran again";
  std::vector<std::string> again = more;
  again.push_back("--retry-failed");
  EXPECT_EQ(sweep(again).status, 1);
  EXPECT_NE(std::filesystem::last_write_time(file), before);
}

TEST_F(SweepCommand, ShardsAndMergeGiveTheWholeSweep) {
  const std::vector<std::string> vary{"--vary", "topology.resources=1..4", "--vary", "memory.l2_kib=64,512"};
  std::vector<std::string> whole = vary, merged = vary;
  whole.insert(whole.end(), {"--out", "whole"});
  merged.insert(merged.end(), {"--out", "merged"});
  ASSERT_EQ(sweep(whole).status, 0);
  for (int i = 1; i <= 4; ++i) {
    const std::string folder = "shard" + std::to_string(i);
    std::vector<std::string> part = vary;
    part.insert(part.end(), {"--out", folder, "--shard", std::to_string(i) + "/4"});
    ASSERT_EQ(sweep(part).status, 0);
    EXPECT_FALSE(std::filesystem::exists(program_.folder() / folder / "sweep.sqlite"));
    EXPECT_EQ(points_of(program_.folder() / folder).size(), 2u);
    merged.insert(merged.end(), {"--merge", folder});
  }
  ASSERT_EQ(sweep(merged).status, 0);
  EXPECT_EQ(points_of(program_.folder() / "merged"), points_of(program_.folder() / "whole"));
  EXPECT_THAT(sweep({"--vary", "topology.resources=2", "--shard", "9/8"}).err, HasSubstr("expected I/N"));
}

TEST_F(SweepCommand, DryRunTellsNumberAndTime) {
  const Outcome outcome = sweep({"--vary", "topology.resources=1..16", "--dry-run"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("16 points: 1 done, 0 failed, 15 to run"));
  EXPECT_THAT(outcome.out, HasSubstr("by a first point, which was run and is kept"));
}

TEST_F(SweepCommand, HypercubeIsTheSameForTheSameSeed) {
  const std::vector<std::string> more{
      "--vary", "memory.l2_kib=log:64..4096:7", "--vary", "topology.resources=1..8", "--points", "6", "--seed", "3"};
  ASSERT_EQ(sweep(more).status, 0);
  const Json once = results()["points"];
  EXPECT_EQ(once.size(), 6u);
  ASSERT_EQ(sweep(more).status, 0);
  EXPECT_EQ(results()["points"], once);
}

TEST_F(SweepCommand, TheTableFitsAndNamesItsResults) {
  setenv("COLUMNS", "80", 1);
  const Outcome outcome = program_.run({"sweep", "a.yaml", "--vary", "topology.resources=2,4", "--vary",
                                        "memory.l2_kib=64,512", "--pareto", "cycles,bytes"});
  unsetenv("COLUMNS");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("Pareto front of cycles and bytes"));
  EXPECT_THAT(outcome.out, HasSubstr("Main effects on cycles"));
  EXPECT_THAT(outcome.out, HasSubstr("4 points: 4 done, 0 failed, 0 to run"));
  std::size_t begin = 0;
  for (std::size_t end; (end = outcome.out.find('\n', begin)) != std::string::npos; begin = end + 1)
    EXPECT_LE(end - begin, 80u) << outcome.out.substr(begin, end - begin);
}

TEST_F(SweepCommand, GoalsThatNoPointWillHaveAreRefusedBeforeTheFirstPoint) {
  const Outcome costs = sweep({"--vary", "topology.resources=2,4", "--pareto", "cycles,mm2"});
  EXPECT_EQ(costs.status, 2);
  EXPECT_THAT(costs.err, HasSubstr("mm2 is a result of runs with energy.profile=n7; expected --set energy.profile=n7"));
  const Outcome native =
      sweep({"--vary", "topology.resources=2,4", "--pareto", "cycles,bytes", "--set", "engine.kind=native"});
  EXPECT_EQ(native.status, 2);
  EXPECT_THAT(native.err, HasSubstr("cycles is a result of runs with engine.kind=cycle"));
  EXPECT_FALSE(std::filesystem::exists(program_.folder() / "out/a/sweep.json"));
}

TEST_F(SweepCommand, TheChosenResultsAreShownHoweverNarrowTheTerminalIs) {
  setenv("COLUMNS", "60", 1);
  const Outcome outcome = program_.run(
      {"sweep", "a.yaml", "--vary", "topology.resources=2,4", "--set", "energy.profile=n7", "--pareto", "cycles,mm2"});
  unsetenv("COLUMNS");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::string front = outcome.out.substr(outcome.out.find("Pareto front"));
  EXPECT_THAT(front.substr(0, front.find("no room here")), HasSubstr("  cycles     mm2  "));
}

}  // namespace
}  // namespace carousel::sweep_command_test
