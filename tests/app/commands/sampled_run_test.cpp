// Sampled runs as a user starts them. The truth that their estimates are compared with is a run of its own of the whole
// frame, and the picture of that.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/run/report_json.h"
#include "tests/app/support/program.h"
#include "tests/support/json_schema_check.h"
#include "tests/support/read_exr.h"

namespace carousel::sampled_run_test {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

const char* const kMachine =
    "scene: {builtin: terrain, triangles: 2000}\n"
    "image: {width: 96, height: 64, samples: 1, max_depth: 3}\n"
    "engine: {kind: cycle, threads: 1, what_if: false}\n"
    "energy: {profile: n7}\n"
    "topology: {resources: 2}\n"
    "rays: {slots_per_resource: 32}\n"
    "packets: {rays: 8}\n"
    "collections: {ready: 8}\n";

Json run(const Program& program, std::vector<std::string> more, const std::string& out) {
  std::vector<std::string> arguments{"run", "machine.yaml", "--out", out, "--force", "--quiet"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Outcome outcome = program.run(arguments);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return Json::parse(program.read(out + "/report.json"));
}

const std::vector<std::string> kQuarter{"--set", "sampling.fraction=0.25"};

/// The numbers of a frame that was run whole, from its own sections.
std::map<std::string, double> truth_of(const Json& report) {
  const double rays = report["rays"]["completed"], cycles = report["engine"]["cycles"];
  double packets = 0, lines = 0;
  for (const Json& row : report["bytes"]) {
    if (row["what"] == "packets") packets = row["bytes"];
    if (row["what"] == "lines") lines = row["bytes"];
  }
  return {{"rays", rays},
          {"cycles", cycles},
          {"cycles_per_ray", cycles / rays},
          {"rays_per_kilocycle", report["throughput"]["whole"]["rays_per_kilocycle"]},
          {"box_tests_per_ray", report["tests"]["box"]["per_ray"]},
          {"triangle_tests_per_ray", report["tests"]["triangle"]["per_ray"]},
          {"memory_bytes_per_ray", lines / rays},
          {"nj_per_ray", report["energy"]["nj_per_ray"]},
          {"link_bytes_per_ray", packets / rays}};
}

TEST(SampledRun, EstimatesTheWholeFrame) {
  const Program program;
  program.write("machine.yaml", kMachine);
  const std::map<std::string, double> truth = truth_of(run(program, {}, "whole"));
  std::vector<std::string> audited = kQuarter;
  audited.push_back("--audit");
  const Json report = run(program, audited, "sampled");
  EXPECT_EQ(schema_problems(report::report_schema(), report), std::vector<std::string>{});
  const Json& sampled = report["sampled"];
  EXPECT_EQ(sampled["frame_paths"], 96 * 64);
  EXPECT_NEAR(sampled["paths"].get<double>(), 96 * 64 / 4, 96 * 64 / 16);
  EXPECT_EQ(report["rays"]["by_kind"]["camera"], sampled["paths"]) << "the other sections are about the sample";
  for (const auto& [key, value] : truth) {
    SCOPED_TRACE(key);
    const double estimate = sampled[key]["estimate"];
    EXPECT_NEAR(sampled[key]["whole"].get<double>(), value, 1e-9 * value);
    EXPECT_NEAR(sampled[key]["error"].get<double>(), estimate / value - 1, 1e-9);
    EXPECT_NEAR(estimate, value, (key == "memory_bytes_per_ray" ? 0.4 : 0.15) * value);  // few lines make these bytes
    EXPECT_LE(sampled[key]["low"].get<double>(), value);
    EXPECT_GE(sampled[key]["high"].get<double>(), value);
  }
  for (const Json& use : sampled["uses"]) {
    EXPECT_NEAR(use["estimate"].get<double>(), use["whole"].get<double>(), 0.1) << use["name"];
    EXPECT_LE(use["high"].get<double>(), 1);
  }
  EXPECT_THAT(program.read("sampled/report.html"), HasSubstr("Estimates for the whole frame"));
}

// Drawn by position alone, the triangle tests of these samples are up to 18 % off.
TEST(SampledRun, DrawsSamplesWithTheRaysAndTestsOfTheFrame) {
  const Program program;
  program.write("machine.yaml", kMachine);
  const std::vector<std::string> spheres{"--set", "scene.builtin=spheres"};
  const std::map<std::string, double> truth = truth_of(run(program, spheres, "whole"));
  for (const char* seed : {"3", "4", "5"}) {
    std::vector<std::string> words = kQuarter;
    words.insert(words.end(), {"--set", "scene.builtin=spheres", "--set", std::string("sampling.seed=") + seed});
    const Json report = run(program, words, "sampled");
    const auto off = [&](const char* key) {
      return report["sampled"][key]["estimate"].get<double>() / truth.at(key) - 1;
    };
    EXPECT_NEAR(off("rays"), 0, 0.02) << seed;
    EXPECT_NEAR(off("triangle_tests_per_ray"), 0, 0.06) << seed;
    EXPECT_GT(report["host"]["draw_seconds"], 0);
  }
}

// Lines that every cache fetches once, and lines that it fetches again and again: multiplied by the frame's rays, the
// former were up to 4.4 times the truth.
TEST(SampledRun, EstimatesBytesFromMemoryAndEnergyWhereTheSceneFitsTheCacheAndWhereNot) {
  const Program program;
  program.write("machine.yaml", kMachine);
  for (const auto& [scene, l2_kib, off] :
       {std::tuple{"cornell", "512", 0.2}, {"terrain", "512", 0.2}, {"terrain", "16", 0.3}}) {
    const std::vector<std::string> machine{"--set", std::string("scene.builtin=") + scene, "--set",
                                           std::string("memory.l2_kib=") + l2_kib};
    const Json whole = run(program, machine, "whole");
    const double bytes = truth_of(whole).at("memory_bytes_per_ray"), energy = whole["energy"]["nj_per_ray"];
    for (const char* seed : {"3", "4"}) {
      SCOPED_TRACE(fmt::format("{} {} {}", scene, l2_kib, seed));
      std::vector<std::string> words = machine;
      words.insert(words.end(), {"--set", "sampling.fraction=0.15", "--set", std::string("sampling.seed=") + seed});
      const Json sampled = run(program, words, "sampled")["sampled"];
      for (const auto& [key, truth] : {std::pair{"memory_bytes_per_ray", bytes}, {"nj_per_ray", energy}}) {
        EXPECT_NEAR(sampled[key]["estimate"].get<double>(), truth, off * truth) << key;
        EXPECT_LE(sampled[key]["low"].get<double>(), truth) << key;
        EXPECT_GE(sampled[key]["high"].get<double>(), truth) << key;
      }
    }
  }
}

TEST(SampledRun, SaysWhatItIsOnTheTerminal) {
  const Program program;
  program.write("machine.yaml", kMachine);
  std::vector<std::string> arguments{"run", "machine.yaml", "--audit"};
  arguments.insert(arguments.end(), kQuarter.begin(), kQuarter.end());
  const Outcome outcome = program.run(arguments);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::ContainsRegex("SAMPLED +1,[0-9]+ of 6,144 paths"));
  EXPECT_THAT(outcome.out, testing::ContainsRegex("cycles per ray .* to .* whole .* error [+-]"));
}

TEST(SampledRun, ThePictureHoldsTheDrawnTilesAndNoOther) {
  const Program program;
  program.write("machine.yaml", kMachine);
  run(program, {}, "whole");
  const Json report = run(program, kQuarter, "sampled");
  EXPECT_FALSE(report["digest"].contains("image")) << "a part of a picture is not the picture";
  const auto read = [&](const std::string& folder) { return read_exr(program.folder() / folder / "image.exr").rgb; };
  const std::vector<float> whole = read("whole"), sampled = read("sampled");
  ASSERT_EQ(whole.size(), std::size_t{96} * 64 * 3);
  ASSERT_EQ(sampled.size(), whole.size());
  std::size_t drawn = 0;
  for (std::size_t pixel = 0; pixel < 96 * 64; ++pixel) {
    const auto own = sampled.begin() + static_cast<std::ptrdiff_t>(3 * pixel);
    if (own[0] == 0 && own[1] == 0 && own[2] == 0) continue;
    ++drawn;
    for (std::size_t i = 0; i < 3; ++i) ASSERT_EQ(sampled[3 * pixel + i], whole[3 * pixel + i]) << pixel;
  }
  EXPECT_LE(drawn, report["sampled"]["paths"].get<std::size_t>());
  EXPECT_GE(drawn, report["sampled"]["paths"].get<std::size_t>() / 2);
}

TEST(SampledRun, TheSameSeedDrawsTheSame) {
  const Program program;
  program.write("machine.yaml", kMachine);
  const Json first = run(program, kQuarter, "a"), again = run(program, kQuarter, "b");
  EXPECT_EQ(first["sampled"], again["sampled"]);
  EXPECT_EQ(first["digest"], again["digest"]);
}

TEST(SampledRun, SaysSoWhereTheSampleIsTooSmall) {
  const Program program;
  program.write("machine.yaml", kMachine);
  const Json report =
      run(program, {"--set", "sampling.fraction=0.25", "--set", "rays.slots_per_resource=2048", "--audit"}, "sampled");
  EXPECT_EQ(report["sampled"]["too_small"], true);
  const Json& cycles = report["sampled"]["cycles_per_ray"];
  EXPECT_LE(cycles["low"], cycles["whole"]);
  EXPECT_GE(cycles["high"], cycles["whole"]);
}

TEST(SampledRun, RefusesWhereASampleMakesNoSense) {
  const Program program;
  program.write("machine.yaml", kMachine);
  const auto refused = [&](std::vector<std::string> more, const char* message) {
    more.insert(more.begin(), {"run", "machine.yaml"});
    const Outcome outcome = program.run(more);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr(message));
  };
  refused({"--audit"}, "this run has no estimates");
  refused({"--set", "sampling.fraction=0.1", "--set", "engine.kind=native"}, "the native engine has no sampled runs");
  refused({"--set", "sampling.fraction=0.1", "--set", "faults.resource.kind=stop"}, "happens once in a frame");
  refused({"--set", "sampling.fraction=0.1", "--set", "workload={traffic: {rate: 0.1}}"}, "no rays to draw from");
  refused({"--set", "sampling.fraction=0"}, "sampling.fraction");
}

}  // namespace
}  // namespace carousel::sampled_run_test
