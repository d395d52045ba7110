// The verdict of `carousel run`, tried as its user would: on whole frames larger than the pilot, half sky and half
// ground.
#include <algorithm>
#include <cmath>
#include <thread>
#include <tuple>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/run/report_json.h"
#include "tests/app/support/program.h"
#include "tests/app/support/run_report.h"
#include "tests/support/json_schema_check.h"
#include "tests/support/random_runs.h"

namespace carousel::verdict_run_test {
namespace {

using Json = nlohmann::ordered_json;

/// What the search took as a part of the run, by its log.
double times_of_run(const std::string& log) {
  const std::string before = "took ", after = " times the run";
  const std::size_t end = log.find(after), begin = log.rfind(before, end) + before.size();
  EXPECT_NE(end, std::string::npos) << log;
  return end == std::string::npos ? 0 : std::stod(log.substr(begin, end - begin));
}

class VerdictRun : public testing::Test {
 protected:
  Json run(const std::string& config, const std::vector<std::string>& sets) const {
    return run_report(program_, config, sets);
  }

  const Program program_;
};

// The upper half is sky, which costs shading alone; the ground costs triangle tests. The first paths would name
// shading.
constexpr const char* kTerrain =
    "scene: {builtin: terrain, triangles: 5000}\n"
    "image: {width: 160, height: 120, samples: 2, max_depth: 2}\n"
    "engine: {kind: cycle, threads: 1, what_if: false}\n"
    "topology: {resources: 4}\n"
    "rays: {slots_per_resource: 32}\n"
    "testers: {triangle: {units: 1, interval_cycles: 16}, contexts: 4}\n"
    "memory: {l2_latency_cycles: 8, dram_latency_cycles: 40, shape_buffer_kib: 64}\n"
    "shading: {workers: 16}\n";

TEST_F(VerdictRun, TheNamedClassGainsWhatIsForetoldOfTheWholeFrame) {
  const Json report = run(kTerrain, {"engine.what_if=true"});
  EXPECT_EQ(schema_problems(report::report_schema(), report), std::vector<std::string>{});
  const Json& bottleneck = report["bottleneck"];
  ASSERT_EQ(bottleneck["limits"], "triangle_tests") << bottleneck.dump(1);
  EXPECT_FALSE(bottleneck["whole_frame"]);
  EXPECT_LT(bottleneck["rays"], report["rays"]["completed"]);
  const Json& named = bottleneck["gains"][0];
  std::vector<std::string> sets;
  for (const Json& set : named["sets"]) sets.push_back(set);
  const Json doubled = run(kTerrain, sets);
  const double real = report["engine"]["cycles"].get<double>() / doubled["engine"]["cycles"].get<double>() - 1;
  EXPECT_GE(real, named["low"].get<double>() - 0.01);
  EXPECT_LE(real, named["high"].get<double>() + 0.01);
  EXPECT_LT(named["low"], named["gain"]);
  EXPECT_LE(named["gain"], named["high"]);
  const Json& noise = report["cycle_noise"];
  EXPECT_FALSE(noise["whole_frame"]);
  EXPECT_LT(noise["fraction"], 0.15);
  const Json other = run(kTerrain, {"image.seed=77"});
  EXPECT_GE(other["engine"]["cycles"], noise["low"]) << noise.dump();
  EXPECT_LE(other["engine"]["cycles"], noise["high"]) << noise.dump();
  EXPECT_NE(other["engine"]["cycles"], report["engine"]["cycles"]);
}

// The second frame finds in the caches what the first one left there, and the search finds it there too: else all that
// it simulates would wait for a memory that the frame hardly needed.
TEST_F(VerdictRun, TheLastFrameOfASeriesIsSearchedWithItsWarmCaches) {
  const Json report =
      run(kTerrain, {"engine.what_if=true", "image.width=96", "image.height=64", "image.samples=1",
                     "rays.slots_per_resource=16", "frames={count: 2, step: 0, update: none}", "memory.l2_kib=4096",
                     "memory.shape_buffer_kib=4", "memory.dram_latency_cycles=20000"});
  const Json& rows = report["frames"]["rows"];
  ASSERT_GT(rows[0]["cycles"].get<double>(), 3 * rows[1]["cycles"].get<double>()) << rows.dump(1);
  EXPECT_EQ(report["bottleneck"]["limits"], "triangle_tests") << report["bottleneck"].dump(1);
  EXPECT_LT(std::abs(report["bottleneck"]["deviation"].get<double>()), 0.3);
}

// The search is of the whole machine, whose noise says nothing of cycles in which a resource stopped.
TEST_F(VerdictRun, ARunInWhichAResourceStopsHasNoNoise) {
  const std::vector<std::string> small{"engine.what_if=true", "image.width=96", "image.height=72", "image.samples=1",
                                       "rays.slots_per_resource=16"};
  std::vector<std::string> stops = small;
  stops.emplace_back("faults={resource: {kind: stop, number: 1, after_rays: 200}}");
  const Json report = run(kTerrain, stops);
  EXPECT_FALSE(report["bottleneck"]["gains"].empty());
  EXPECT_FALSE(report.contains("cycle_noise"));
  EXPECT_TRUE(run(kTerrain, small).contains("cycle_noise"));
}

// 300 paths hardly fill 256 slots; the size that is told fills them, and no simulation is spent on the small one.
TEST_F(VerdictRun, AFrameThatIsTooSmallIsToldSoWithTheSizeThatWouldDo) {
  const Json small = run(kTerrain, {"engine.what_if=true", "image.width=20", "image.height=15", "image.samples=1",
                                    "rays.slots_per_resource=64"});
  EXPECT_EQ(schema_problems(report::report_schema(), small), std::vector<std::string>{});
  const Json& told = small["bottleneck"];
  EXPECT_EQ(told["limits"], "");
  EXPECT_TRUE(told["gains"].empty());
  EXPECT_FALSE(small.contains("cycle_noise"));
  EXPECT_EQ(told["frame_too_small"]["paths"], 300);
  EXPECT_EQ(told["frame_too_small"]["slots"], 256);
  const auto least = told["frame_too_small"]["least_paths"].get<std::uint64_t>();
  const std::uint64_t samples = (least + 299) / 300;
  EXPECT_GT(samples, 1u);
  const Json large = run(kTerrain, {"engine.what_if=true", "image.width=20", "image.height=15",
                                    "image.samples=" + std::to_string(samples), "rays.slots_per_resource=64"});
  EXPECT_FALSE(large["bottleneck"].contains("frame_too_small")) << large["bottleneck"].dump(1);
  EXPECT_FALSE(large["bottleneck"]["gains"].empty());
}

// 400 workers are more than a machine may have.
TEST_F(VerdictRun, AClassThatCannotBeDoubledIsToldAsUntried) {
  const Json many = run(kTerrain, {"engine.what_if=true", "shading.workers=200"});
  EXPECT_EQ(schema_problems(report::report_schema(), many), std::vector<std::string>{});
  const Json& untried = many["bottleneck"]["untried"];
  ASSERT_EQ(untried.size(), 1u) << untried.dump(1);
  EXPECT_EQ(untried[0]["name"], "shading");
  EXPECT_EQ(untried[0]["action"], "twice shading.workers");
  EXPECT_THAT(untried[0]["why"].get<std::string>(), testing::StartsWith("shading.workers: "));
  EXPECT_THAT(many["bottleneck"]["verdict"].get<std::string>(), testing::HasSubstr("; not tried: shading ("));
  EXPECT_TRUE(run(kTerrain, {"engine.what_if=true", "shading.workers=128"})["bottleneck"]["untried"].empty());
}

// The machine is full for most of this frame, but each pilot would be a good part of it.
TEST_F(VerdictRun, AFrameThatIsTooSmallForASearchIsToldSoWithItsBusiestPart) {
  const std::vector<std::string> frame{"engine.what_if=true", "image.width=32", "image.height=24",
                                       "rays.slots_per_resource=16"};
  std::vector<std::string> sets = frame;
  sets.emplace_back("image.samples=1");
  const Json small = run(kTerrain, sets);
  EXPECT_EQ(schema_problems(report::report_schema(), small), std::vector<std::string>{});
  const Json& told = small["bottleneck"];
  EXPECT_EQ(told["limits"], "");
  EXPECT_TRUE(told["gains"].empty());
  ASSERT_TRUE(told.contains("frame_too_small")) << told.dump(1);
  EXPECT_EQ(told["frame_too_small"]["search"], true);
  EXPECT_GE(told["frame_too_small"]["between"].get<double>(), 0.75);
  EXPECT_EQ(told["frame_too_small"]["busiest"], "triangle_tests");
  EXPECT_NEAR(told["frame_too_small"]["busy"].get<double>(), small["bound"]["reached"].get<double>(), 1e-6);
  EXPECT_THAT(told["verdict"].get<std::string>(), testing::HasSubstr("too few for a search"));
  const auto least = told["frame_too_small"]["least_paths"].get<std::uint64_t>();
  sets.back() = fmt::format("image.samples={}", (least + 767) / 768);
  const Json large = run(kTerrain, sets)["bottleneck"];
  EXPECT_FALSE(large.contains("frame_too_small")) << large.dump(1);
  EXPECT_FALSE(large["gains"].empty());
}

TEST_F(VerdictRun, ASearchKeepsItsBudgetAlsoOfSmallFrames) {
  int searched = 0;
  for (const char* size : {"40", "56", "72", "96", "128"})
    for (const char* slots : {"16", "64"}) {
      program_.write("a.yaml", kTerrain);
      const Outcome outcome = program_.run(
          {"run", "a.yaml", "--set", "engine.what_if=true", "--set", "image.samples=1", "--set",
           std::string("image.width=") + size, "--set", std::string("image.height=") + size, "--set",
           std::string("rays.slots_per_resource=") + slots, "--force", "--out", "out", "--log-level", "debug"});
      ASSERT_EQ(outcome.status, 0) << outcome.err;
      const Json bottleneck = Json::parse(program_.read("out/report.json"))["bottleneck"];
      if (bottleneck.contains("frame_too_small")) continue;
      EXPECT_LE(times_of_run(outcome.err), 1.85) << size << " pixels, " << slots << " slots";
      ++searched;
    }
  EXPECT_GE(searched, 4);
}

// Shading is busy for a small part of the time, and storage is never short. No simulation is spent on them, and doubled
// for real they gain no more than the ledger says.
TEST_F(VerdictRun, WhatTheLedgerBoundsIsNotSimulated) {
  const Json report = run(kTerrain, {"engine.what_if=true"});
  int bounded = 0;
  for (const Json& gain : report["bottleneck"]["gains"]) {
    if (gain["together"] != 0) continue;
    ++bounded;
    if (gain["name"] != "dispatch" && gain["name"] != "shading" && gain["name"] != "packets_in_flight") continue;
    std::vector<std::string> sets;
    for (const Json& set : gain["sets"]) sets.push_back(set);
    const Json again = run(kTerrain, sets);
    const double real = report["engine"]["cycles"].get<double>() / again["engine"]["cycles"].get<double>() - 1;
    EXPECT_LE(real, gain["high"].get<double>()) << gain.dump();
  }
  EXPECT_GE(bounded, 3) << report["bottleneck"].dump(1);
}

// No part of a frame whose reads are all first ones is like it, but the frame's own beginning is as cold as the frame.
TEST_F(VerdictRun, OfColdCachesTheFramesBeginningTells) {
  std::vector<std::string> sets{"engine.what_if=true", "image.width=96", "image.height=72", "scene.triangles=20000"};
  for (const char* set : {"rays.slots_per_resource=16", "memory.l2_kib=4096", "memory.dram_bytes_per_cycle=1",
                          "memory.shape_buffer_kib=4", "testers.triangle.units=8", "testers.box.units=16"})
    sets.emplace_back(set);
  const Json frame = run(kTerrain, sets);
  const Json& bottleneck = frame["bottleneck"];
  ASSERT_TRUE(bottleneck.contains("cold_caches")) << bottleneck.dump(1);
  const std::string named = bottleneck["limits"];
  const Json& gains = bottleneck["gains"];
  const auto gain = std::find_if(gains.begin(), gains.end(), [&](const Json& one) { return one["name"] == named; });
  ASSERT_NE(gain, gains.end());
  EXPECT_EQ((*gain)["together"], 1);
  EXPECT_GT((*gain)["frame"].get<double>(), 0.1);
  sets[0] = "engine.what_if=false";
  for (const Json& set : (*gain)["sets"]) sets.push_back(set);
  const double real =
      frame["engine"]["cycles"].get<double>() / run(kTerrain, sets)["engine"]["cycles"].get<double>() - 1;
  EXPECT_GE(real, (*gain)["low"].get<double>());
  EXPECT_LE(real, (*gain)["high"].get<double>());
}

// Every line is read once from a slow memory, since the L2 holds the scene: memory limits this frame, and no larger
// one. With an L2 that holds little, lines are read again and again, as in a frame of any size. Where 29 % of the reads
// are first ones, memory would gain most without them. Where tests limit the same frame, its first reads do not matter.
TEST_F(VerdictRun, OfColdCachesItSaysWhetherALargerPictureIsLimitedSo) {
  const std::vector<std::string> frame{
      "engine.what_if=true",        "image.width=96",    "image.height=72", "scene.triangles=20000",
      "rays.slots_per_resource=16", "memory.l2_kib=4096"};
  std::vector<std::string> slow = frame;
  for (const char* set : {"memory.dram_bytes_per_cycle=1", "memory.shape_buffer_kib=4", "testers.triangle.units=8",
                          "testers.triangle.interval_cycles=1", "testers.box.units=16", "shading.workers=8"})
    slow.emplace_back(set);
  const Json cold = run(kTerrain, slow);
  EXPECT_EQ(schema_problems(report::report_schema(), cold), std::vector<std::string>{});
  ASSERT_TRUE(cold["bottleneck"].contains("cold_caches")) << cold["bottleneck"].dump(1);
  EXPECT_EQ(cold["bottleneck"]["limits"], "memory_bandwidth");
  EXPECT_NE(cold["bottleneck"]["cold_caches"]["when_warm"], "memory_bandwidth") << cold["bottleneck"].dump(1);
  EXPECT_EQ(cold["bottleneck"]["cold_caches"]["first"], cold["bottleneck"]["cold_caches"]["reads"]);
  slow.emplace_back("memory.l2_kib=128");
  const Json partly = run(kTerrain, slow);
  ASSERT_TRUE(partly["bottleneck"].contains("cold_caches")) << partly["bottleneck"].dump(1);
  EXPECT_EQ(partly["bottleneck"]["cold_caches"]["when_warm"], "memory_bandwidth");
  EXPECT_EQ(partly["bottleneck"]["limits"], "memory_bandwidth");
  slow.emplace_back("memory.l2_kib=4");
  const Json warm = run(kTerrain, slow)["bottleneck"];
  EXPECT_FALSE(warm.contains("cold_caches")) << warm["cold_caches"].dump();
  EXPECT_EQ(warm["limits"], "memory_bandwidth") << warm.dump(1);
  const Json report = run(kTerrain, frame), tests = report["bottleneck"];
  EXPECT_GT(report["cycle_noise"]["paths"], tests["paths"]) << "the search had rays left for larger ones";
  EXPECT_FALSE(tests.contains("cold_caches")) << tests["cold_caches"].dump();
  EXPECT_EQ(tests["limits"], "triangle_tests") << tests.dump(1);
}

// The sky comes first and costs shading alone; with few workers it limits the machine, and then triangle tests do.
TEST_F(VerdictRun, EachPhaseHasItsOwnVerdict) {
  const Json report = run(kTerrain, {"engine.what_if=true", "shading.workers=1", "shading.cycles_per_shade=45"});
  const Json& phases = report["bottleneck"]["phases"];
  ASSERT_GE(phases.size(), 2u) << report["bottleneck"].dump(1);
  EXPECT_EQ(phases.front()["limits"], "shading");
  EXPECT_EQ(phases.back()["limits"], "triangle_tests");
  double time = 0, at = 0;
  for (const Json& phase : phases) {
    EXPECT_EQ(phase["begin"], at);
    at = phase["end"];
    time += phase["time"].get<double>();
  }
  EXPECT_EQ(at, 1);
  EXPECT_NEAR(time, 1, 1e-9);
}

// One simulation of few resources is fastest on one thread; those of the search have nothing to do with each other.
TEST_F(VerdictRun, TheSearchTakesAllCoresUnlessTheConfigurationSaysHowMany) {
  const auto cores = std::max(1u, std::thread::hardware_concurrency());
  for (const auto& [threads, run, beside] :
       {std::tuple{"auto", "1, chosen", cores}, {"1", "1\n", 1u}, {"3", "3\n", 3u}}) {
    program_.write("a.yaml", kTerrain);
    const Outcome outcome = program_.run({"run", "a.yaml", "--set", "engine.what_if=true", "--set", "image.width=48",
                                          "--set", "image.height=32", "--set", std::string("engine.threads=") + threads,
                                          "--force", "--log-level", "debug"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.err, testing::HasSubstr(fmt::format("threads: {}", run)));
    EXPECT_THAT(outcome.err, testing::HasSubstr(fmt::format("search: up to {} simulations at once", beside)));
  }
}

// Nothing comes near to what more testers gain here, so that the frame's beginning is simulated for no other class.
TEST_F(VerdictRun, ClassesThatAnotherOneSurelyBeatsCostNoBeginning) {
  if (!long_tests_run()) GTEST_SKIP() << kInSoak;
  program_.write("a.yaml", kTerrain);
  const Outcome outcome = program_.run({"run", "a.yaml", "--set", "engine.what_if=true", "--set", "image.width=256",
                                        "--set", "image.height=160", "--out", "out", "--log-level", "debug"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(Json::parse(program_.read("out/report.json"))["bottleneck"]["limits"], "triangle_tests");
  const double times = times_of_run(outcome.err);
  EXPECT_LT(times, 0.75);
  EXPECT_GT(times, 0.3);
}

// More testers gain more than twice what anything else does, and the pilot knows it.
TEST_F(VerdictRun, ASearchThatIsSureAfterItsPilotStops) {
  program_.write("a.yaml", kTerrain);
  const Outcome outcome =
      program_.run({"run", "a.yaml", "--set", "engine.what_if=true", "--out", "out", "--log-level", "debug"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(Json::parse(program_.read("out/report.json"))["bottleneck"]["limits"], "triangle_tests");
  EXPECT_LT(times_of_run(outcome.err), 0.7);
}

// The pilots of this picture are small beside it, half sky, and not quite like the run.
TEST_F(VerdictRun, AShippedMachineWithAnotherSeedNamesTheSamePart) {
  const Outcome outcome = program_.run(
      {"run", CAROUSEL_SOURCE_DIR "/configs/xe2_like.yaml", "--quiet", "--set", "image.seed=2", "--out", "out"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json bottleneck = Json::parse(program_.read("out/report.json"))["bottleneck"];
  EXPECT_EQ(bottleneck["limits"], "shading") << bottleneck.dump(1);
  EXPECT_EQ(bottleneck["unlike"], "");
}

TEST_F(VerdictRun, TheSteadyRateIsNeverAboveTheBound) {
  for (const char* shading : {"shading.workers=16", "shading.workers=1"}) {
    const Json report = run(kTerrain, {shading});
    ASSERT_TRUE(report["throughput"].contains("steady"));
    EXPECT_LE(report["throughput"]["steady"]["rays_per_kilocycle"], report["bound"]["rays_per_kilocycle"]);
    EXPECT_GE(report["throughput"]["steady"]["rays_per_kilocycle"].get<double>(),
              0.9 * report["throughput"]["whole"]["rays_per_kilocycle"].get<double>());
  }
}

// A bus is one medium: one so narrow that nothing else counts is nearly always busy. Before issue 16 its bound was that
// of all its half-links side by side, 16 times too high with eight resources.
TEST_F(VerdictRun, TheBoundOfABusIsThatOfOneMedium) {
  const Json report = run(
      kTerrain, {"topology.shape=bus", "topology.resources=8", "topology.link.bytes_per_cycle=1", "image.samples=1"});
  EXPECT_EQ(report["bound"]["classes"][0]["name"], "link_bandwidth");
  EXPECT_GT(report["bound"]["reached"], 0.7);
  EXPECT_LE(report["bound"]["reached"], 1.0);
}

}  // namespace
}  // namespace carousel::verdict_run_test
