// The search for the best split of an area, as a user starts it: its trials, its machine, and what is refused.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel::area_search_test {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kMachine =
    "scene: {builtin: terrain, triangles: 2000}\n"
    "image: {width: 24, height: 16, samples: 1, max_depth: 2}\n"
    "engine: {kind: cycle, what_if: false}\n"
    "topology: {resources: 2, shape: ring}\n"
    "rays: {slots_per_resource: 64}\n"
    "collections: {when_full: spill}\n"
    "memory: {shape_buffer_kib: 8, l2_kib: 128, shared_by: 2}\n"
    "energy: {profile: n45}\n"
    "area: {budget_mm2: 12, fit: best}\n";

class AreaSearchRun : public testing::Test {
 protected:
  Outcome start(std::vector<std::string> words, const std::vector<std::string>& sets = {},
                const std::string& machine = kMachine) {
    program_.write("machine.yaml", machine);
    words.insert(words.begin() + 1, "machine.yaml");
    add_sets(words, sets);
    return program_.run(words);
  }
  Json run(const std::vector<std::string>& sets = {}) {
    const Outcome outcome = start({"run", "--out", "out", "--force"}, sets);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    said_ = outcome.out;
    return outcome.status == 0 ? Json::parse(program_.read("out/report.json")) : Json();
  }
  std::string refused(const std::vector<std::string>& sets,
                      const std::vector<std::string>& words = {"run", "--quiet"}) {
    const Outcome outcome = start(words, sets);
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_FALSE(std::filesystem::exists(program_.folder() / "out/machine"));
    return outcome.err;
  }

  Program program_;
  std::string said_;
};

/// What a trial has of each part for a resource, as powers of two of the given machine's.
std::array<int, 4> steps_of(const Json& trial, const Json& first) {
  const auto step = [&](const char* key, double per) {
    return static_cast<int>(std::lround(std::log2(trial[key].get<double>() / first[key].get<double>() / per)));
  };
  const double more = trial["resources"].get<double>() / first["resources"].get<double>();
  return {step("testers", 1), step("l2_kib", more), step("l2_lines_per_cycle", 1), step("shader_workers", more)};
}

TEST_F(AreaSearchRun, TakesTheFastestSplitWithinTheBudget) {
  const Json r = run();
  const Json& search = r["area"]["search"];
  EXPECT_EQ(search["budget_mm2"], 12);
  EXPECT_EQ(search["fraction"], 1);
  const Json& trials = search["trials"];
  ASSERT_GT(trials.size(), 5u);
  ASSERT_LE(trials.size(), 40u);
  const Json* chosen = nullptr;
  double least = trials[0]["cycles"];
  for (const Json& trial : trials) {
    EXPECT_LE(trial["mm2"].get<double>(), 12);
    least = std::min(least, trial["cycles"].get<double>());
    if (trial["chosen"] == true) {
      EXPECT_EQ(chosen, nullptr);
      chosen = &trial;
    }
  }
  ASSERT_NE(chosen, nullptr);
  EXPECT_EQ((*chosen)["cycles"], least);
  // Each part of the chosen split was tried with twice and half of it, unless such a machine is not there.
  std::vector<std::array<int, 4>> tried;
  for (const Json& trial : trials) tried.push_back(steps_of(trial, trials[0]));
  const std::array<int, 4> best = steps_of(*chosen, trials[0]);
  int neighbours = 0;
  for (const std::array<int, 4>& other : tried) {
    int distance = 0;
    for (std::size_t i = 0; i < 4; ++i) distance += std::abs(other[i] - best[i]);
    neighbours += distance == 1;
  }
  EXPECT_GE(neighbours, 4);
  EXPECT_EQ(search["ended"], "no neighbour of the chosen split is faster");
  // The run is that of the chosen machine, and a run of this machine alone is the same.
  EXPECT_EQ(r["engine"]["cycles"], least);
  EXPECT_EQ(r["config"]["topology"]["resources"], (*chosen)["resources"]);
  EXPECT_EQ(r["config"]["memory"]["l2_kib"], (*chosen)["l2_kib"]);
  EXPECT_EQ(r["config"]["shading"]["workers"], (*chosen)["shader_workers"]);
  EXPECT_EQ(r["area"]["mm2"], (*chosen)["mm2"]);
  EXPECT_THAT(said_, HasSubstr("best of " + std::to_string(trials.size()) + " splits"));
  EXPECT_THAT(program_.read("out/report.html"), HasSubstr("Splits of the area"));
  program_.write("chosen.json", r["config"].dump());
  const Outcome again = program_.run({"run", "chosen.json", "--out", "again", "--quiet"});
  ASSERT_EQ(again.status, 0) << again.err;
  const Json alone = Json::parse(program_.read("again/report.json"));
  EXPECT_EQ(alone["engine"]["cycles"], r["engine"]["cycles"]);
  EXPECT_EQ(alone["energy"]["joules"], r["energy"]["joules"]);
  EXPECT_EQ(alone["digest"], r["digest"]);
  EXPECT_FALSE(alone["area"].contains("search"));
  EXPECT_EQ(search["aim"], "cycles");
  // Nothing is lost by it, and the machine of area.fit: all is no faster.
  const Json all = run({"area.fit=all"});
  EXPECT_EQ(all["digest"], r["digest"]);
  EXPECT_EQ(all["engine"]["cycles"], trials[0]["cycles"]);
  EXPECT_GE(all["engine"]["cycles"].get<double>(), least);
}

/// Of some trials the one with the least of a number.
const Json& least(const Json& trials, const char* key) {
  return *std::min_element(trials.begin(), trials.end(), [&](const Json& a, const Json& b) { return a[key] < b[key]; });
}

TEST_F(AreaSearchRun, AimsAtCyclesOrJoules) {
  const Json fast = run(), thrifty = run({"area.aim=joules"});
  const Json &search = thrifty["area"]["search"], &trials = search["trials"];
  EXPECT_EQ(search["aim"], "joules");
  EXPECT_EQ(search["ended"], "no neighbour of the chosen split takes fewer joules");
  const Json& chosen = least(trials, "nj_per_ray");
  EXPECT_EQ(chosen["chosen"], true);
  EXPECT_EQ(thrifty["energy"]["nj_per_ray"], chosen["nj_per_ray"]) << "the run is that of the chosen machine";
  EXPECT_EQ(thrifty["config"]["topology"]["resources"], chosen["resources"]);
  const double times = trials[0]["nj_per_ray"].get<double>() / chosen["nj_per_ray"].get<double>();
  EXPECT_GT(times, 1.01);
  EXPECT_THAT(said_, HasSubstr(fmt::format("{:.3g} times the rays a joule of the first", times)));
  // It is another machine than the fastest one, takes fewer joules than it, and more cycles.
  EXPECT_EQ(fast["energy"]["nj_per_ray"], least(fast["area"]["search"]["trials"], "cycles")["nj_per_ray"]);
  EXPECT_LT(thrifty["energy"]["nj_per_ray"], fast["energy"]["nj_per_ray"]);
  EXPECT_GT(thrifty["engine"]["cycles"], fast["engine"]["cycles"]);
  EXPECT_EQ(thrifty["digest"], fast["digest"]);
  EXPECT_EQ(trials[0], fast["area"]["search"]["trials"][0]) << "both begin with the machine of fit: all";
  // A run of this machine alone ignores nothing and takes the same joules.
  program_.write("chosen.json", thrifty["config"].dump());
  const Outcome alone = program_.run({"run", "chosen.json", "--out", "alone", "--quiet"});
  ASSERT_EQ(alone.status, 0) << alone.err;
  EXPECT_THAT(alone.err, Not(HasSubstr("area.aim")));
  EXPECT_EQ(Json::parse(program_.read("alone/report.json"))["energy"]["joules"], thrifty["energy"]["joules"]);
}

TEST_F(AreaSearchRun, AnAimWithoutASearchIsIgnored) {
  const Outcome outcome = start({"run", "--out", "out"}, {"area.fit=all", "area.aim=joules"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("area.aim (area.fit is not best)"));
}

TEST_F(AreaSearchRun, IsTheSameAgain) {
  const std::vector<std::string> small{"image.width=12", "image.height=8"};
  const Json first = run(small);
  ASSERT_EQ(start({"run", "--out", "out", "--quiet"}, small).status, 0) << "in its own folder";
  EXPECT_EQ(Json::parse(program_.read("out/report.json"))["area"]["search"], first["area"]["search"]);
  EXPECT_EQ(run({small[0], small[1], "engine.threads=2"})["area"]["search"], first["area"]["search"]);
  const Outcome resolved = program_.run({"run", "out/config.resolved.yaml", "--out", "again", "--quiet"});
  ASSERT_EQ(resolved.status, 0) << resolved.err;
  EXPECT_EQ(Json::parse(program_.read("again/report.json"))["area"]["search"], first["area"]["search"]);
}

TEST_F(AreaSearchRun, LargeFramesAreSampled) {
  const Json r = run({"image.width=512", "image.height=400", "image.max_depth=1", "area.aim=joules"});
  EXPECT_NEAR(r["area"]["search"]["fraction"].get<double>(), 200000.0 / (512 * 400), 1e-9);
  EXPECT_FALSE(r.contains("sampled")) << "the run itself is whole";
  std::vector<double> foretold, of_frame;
  for (const Json& trial : r["area"]["search"]["trials"]) {
    foretold.push_back(trial["nj_per_ray"]);
    if (trial.contains("frame_nj_per_ray")) of_frame.push_back(trial["frame_nj_per_ray"]);
  }
  std::sort(foretold.begin(), foretold.end());
  std::sort(of_frame.begin(), of_frame.end());
  ASSERT_EQ(of_frame.size(), 2u) << "the two best are simulated whole";
  EXPECT_EQ(r["energy"]["nj_per_ray"], of_frame[0]) << "and the better one is taken";
  for (const Json& trial : r["area"]["search"]["trials"]) {
    EXPECT_EQ(trial.contains("frame_nj_per_ray"), trial["nj_per_ray"].get<double>() <= foretold[1]);
    EXPECT_EQ(trial.contains("frame_cycles"), trial.contains("frame_nj_per_ray"));
    if (trial["chosen"] == true) {
      EXPECT_EQ(trial["frame_nj_per_ray"], of_frame[0]);
      EXPECT_EQ(trial["frame_cycles"], r["engine"]["cycles"]);
      EXPECT_NEAR(trial["cycles"].get<double>() / trial["frame_cycles"].get<double>(), 1, 0.1);
      EXPECT_NEAR(trial["nj_per_ray"].get<double>() / of_frame[0], 1, 0.1);
    }
  }
  EXPECT_THAT(program_.read("out/report.html"), HasSubstr("frame cycles"));
}

TEST_F(AreaSearchRun, EachPointOfASweepGetsItsBest) {
  program_.write("machine.yaml", kMachine);
  const std::vector<std::string> small{"--set", "image.width=12", "--set", "image.height=8"};
  const auto started = [&](std::vector<std::string> words) {
    words.insert(words.end(), small.begin(), small.end());
    const Outcome outcome = program_.run(words);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  };
  started({"sweep", "machine.yaml", "--vary", "area.budget_mm2=12,16", "--vary", "area.fit=all,best", "--out", "grid",
           "--quiet"});
  const Json sweep = Json::parse(program_.read("grid/sweep.json"));
  ASSERT_EQ(sweep["points"].size(), 4u);
  int searched = 0;
  for (const auto& file : std::filesystem::directory_iterator(program_.folder() / "grid/points")) {
    const Json point = Json::parse(program_.read("grid/points/" + file.path().filename().string()));
    const bool best = point["keys"]["area.fit"] == "best";
    ASSERT_EQ(point["report"]["area"].contains("search"), best);
    if (!best) continue;
    ++searched;
    started({"run", "machine.yaml", "--set", "area.budget_mm2=" + point["keys"]["area.budget_mm2"].dump(), "--out",
             "one", "--force", "--quiet"});
    const Json alone = Json::parse(program_.read("one/report.json"));
    EXPECT_EQ(point["report"]["area"], alone["area"]);
    EXPECT_EQ(point["report"]["engine"]["cycles"], alone["engine"]["cycles"]);
    EXPECT_EQ(point["report"]["digest"], alone["digest"]);
  }
  EXPECT_EQ(searched, 2);
}

TEST_F(AreaSearchRun, WhatHasNoMeaningIsRefusedFirst) {
  EXPECT_THAT(refused({"area.budget_mm2=2"}), HasSubstr("no number of resources makes a machine of at most 2 mm2"));
  EXPECT_THAT(refused({"energy.profile=none"}), HasSubstr("an area needs a process"));
  EXPECT_THAT(refused({"energy.profile=none", "area.aim=joules"}), HasSubstr("expected energy.profile: n45 or n7"));
  EXPECT_THAT(refused({"area.aim=joule"}), HasSubstr("joules"));
  EXPECT_THAT(refused({"engine.kind=native", "energy.profile=none"}), HasSubstr("area.fit"));
  EXPECT_THAT(refused({"workload={traffic: {packets: 100}}"}), HasSubstr("splits are compared by rays"));
  EXPECT_THAT(refused({}, {"accuracy"}), HasSubstr("only carousel run, sweep and versus search for a split"));
  const Outcome other = start({"run", "--out", "out", "--quiet"}, {"area.fit=all"});
  ASSERT_EQ(other.status, 0) << other.err;
  const std::string report = program_.read("out/report.json");
  // A scene that is not there comes after the folder: neither is loaded for nothing.
  EXPECT_THAT(refused({}, {"run", "--out", "out"}), HasSubstr("--out"));
  EXPECT_EQ(program_.read("out/report.json"), report);
}

TEST_F(AreaSearchRun, BothMachinesOfVersusGetTheirBest) {
  const Outcome outcome =
      start({"versus", "--seeds", "1", "--no-search", "--out", "v", "--quiet"}, {"area.aim=joules"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json versus = Json::parse(program_.read("v/versus.json"));
  for (const auto& [search, index] : {std::pair{"search", 0}, std::pair{"twin_search", 2}}) {
    const Json& trials = versus[search]["trials"];
    const auto chosen =
        std::find_if(trials.begin(), trials.end(), [](const Json& trial) { return trial["chosen"] == true; });
    ASSERT_NE(chosen, trials.end());
    EXPECT_EQ((*chosen)["resources"], versus["machines"][index]["resources"]) << search;
    EXPECT_EQ((*chosen)["cycles"], versus["runs"][index]["cycles"]) << search;
    EXPECT_EQ(versus[search]["aim"], "joules");
    EXPECT_EQ(&*chosen, &least(trials, "nj_per_ray"));
  }
  EXPECT_LE(versus["machines"][2]["mm2"].get<double>(), versus["machines"][0]["mm2"].get<double>());
  EXPECT_THAT(program_.read("v/versus.html"), HasSubstr("Of the twin at equal area"));
}

}  // namespace
}  // namespace carousel::area_search_test
