#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/config/load/load.h"
#include "core/config/write.h"
#include "report/run/report_json.h"
#include "tests/app/support/program.h"
#include "tests/support/json_schema_check.h"

namespace carousel::run_command_test {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;
using testing::IsEmpty;

const char* const kSmall =
    "scene: {builtin: cornell}\nimage: {width: 16, height: 12, samples: 2}\n"
    "engine: {threads: 2}\ntopology: {resources: 3}\n";

TEST(RunCommand, LeavesPictureReportAndResolvedConfig) {
  const Program program;
  program.write("small.yaml", kSmall);
  const Outcome outcome = program.run({"run", "small.yaml", "--set", "verify=reference"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("0 mismatches"));
  EXPECT_THAT(outcome.out, HasSubstr("files        out/small\n"));
  EXPECT_THAT(program.read("out/small/image.png"), HasSubstr("PNG"));
  EXPECT_FALSE(program.read("out/small/image.exr").empty());

  const Json report = Json::parse(program.read("out/small/report.json"));
  EXPECT_EQ(schema_problems(report::report_schema(), report), std::vector<std::string>{});
  EXPECT_EQ(report["incomplete"], false);
  EXPECT_EQ(report["rays"]["emitted"], report["rays"]["completed"]);
  EXPECT_EQ(report["rays"]["by_kind"]["camera"], 16 * 12 * 2);
  EXPECT_EQ(report["packets"]["issued"], report["packets"]["retired"]);
  EXPECT_EQ(report["verify"]["compared"], report["rays"]["completed"]);
  EXPECT_EQ(report["resources"].size(), 3u);
  EXPECT_EQ(report["links"].size(), 3u);

  const Config resolved = load_config(read_config_file(program.folder() / "out/small/config.resolved.yaml")).config;
  EXPECT_EQ(config_json(resolved), report["config"]);
}

// On either engine the picture is that of the run without the fault; or the run ends and says what is missing.
TEST(RunCommand, GoesOnWithoutAResourceThatStops) {
  const Program program;
  program.write("small.yaml", kSmall);
  ASSERT_EQ(program.run({"run", "small.yaml", "--out", "whole"}).status, 0);
  const Json whole = Json::parse(program.read("whole/report.json"));
  for (const std::string engine : {"native", "cycle"}) {
    std::vector<std::string> run{"run",
                                 "small.yaml",
                                 "--force",
                                 "--out",
                                 "out",
                                 "--set",
                                 "engine.kind=" + engine,
                                 "--set",
                                 "engine.what_if=false",
                                 "--set",
                                 "rays.slots_per_resource=64",
                                 "--set",
                                 "faults.resource.kind=stop",
                                 "--set",
                                 "faults.resource.number=1",
                                 "--set",
                                 "faults.resource.after_rays=20"};
    if (engine == "cycle") run.insert(run.end(), {"--set", "faults.compare=true"});
    const Outcome outcome = program.run(run);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const Json report = Json::parse(program.read("out/report.json"));
    EXPECT_EQ(schema_problems(report::report_schema(), report), std::vector<std::string>{});
    EXPECT_EQ(report["digest"], whole["digest"]);
    EXPECT_GT(report["rays"]["restarted"], 0);
    EXPECT_GE(report["rays"]["restarted"], report["rays"]["paths_restarted"]);
    EXPECT_EQ(report["faults"]["stop"]["resource"], 1);
    if (engine == "cycle") {
      EXPECT_EQ(report["faults"]["same_hits"], true);
      EXPECT_EQ(
          report["engine"]["cycles"].get<std::int64_t>(),
          report["faults"]["cycles_without"].get<std::int64_t>() + report["faults"]["cycles_lost"].get<std::int64_t>());
    }
    run.insert(run.end(), {"--set", "faults.resource.recover=false"});
    const Outcome lost = program.run(run);
    EXPECT_EQ(lost.status, 1);
    EXPECT_THAT(lost.err, HasSubstr("resource 1 stopped and faults.resource.recover is off: "));
  }
}

TEST(RunCommand, TheRasteriserLeavesTheRestToASimulatedMachine) {
  const Program program;
  program.write("small.yaml", kSmall);
  const std::vector<std::string> raster{"run",   "small.yaml",     "--set", "primary=raster",  // enough for a search
                                        "--set", "image.width=48", "--set", "image.height=36", "--out"};
  const auto with = [&](std::vector<std::string> more) {
    std::vector<std::string> all = raster;
    all.insert(all.end(), more.begin(), more.end());
    return program.run(all);
  };
  ASSERT_EQ(with({"native"}).status, 0);
  const Outcome outcome =
      with({"cycle", "--set", "engine.kind=cycle", "--set", "verify=reference", "--set", "rays.slots_per_resource=8"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json native = Json::parse(program.read("native/report.json")),
             cycle = Json::parse(program.read("cycle/report.json"));
  EXPECT_EQ(cycle["digest"], native["digest"]);
  EXPECT_EQ(cycle["rays"]["by_kind"]["camera"], 0);
  EXPECT_EQ(cycle["raster"], native["raster"]);
  EXPECT_FALSE(cycle["bottleneck"]["gains"].empty());
}

TEST(RunCommand, TheResolvedConfigGivesTheSameDigests) {
  const Program program;
  program.write("small.yaml", kSmall);
  ASSERT_EQ(program.run({"run", "small.yaml", "--out", "a"}).status, 0);
  ASSERT_EQ(program
                .run({"run", "a/config.resolved.yaml", "--out", "b", "--set", "topology.resources=1", "--set",
                      "collections.traversal=ordered"})
                .status,
            0);
  const Json a = Json::parse(program.read("a/report.json")), b = Json::parse(program.read("b/report.json"));
  EXPECT_EQ(a["digest"], b["digest"]);
  EXPECT_EQ(a["rays"], b["rays"]);
}

TEST(RunCommand, JsonPrintsTheReportAndQuietNothing) {
  const Program program;
  program.write("small.yaml", kSmall);
  const Outcome json = program.run({"run", "small.yaml", "--json"});
  EXPECT_EQ(json.out, program.read("out/small/report.json"));
  const Outcome quiet = program.run({"run", "small.yaml", "--quiet"});
  EXPECT_EQ(quiet.status, 0);
  EXPECT_THAT(quiet.out, IsEmpty());
  EXPECT_THAT(quiet.err, IsEmpty());
}

TEST(RunCommand, DumpedRaysReadBackToTheSameHits) {
  const Program program;
  program.write("small.yaml", kSmall);
  ASSERT_EQ(program.run({"run", "small.yaml", "--hits", "--dump-rays", "rays.csv", "--out", "a"}).status, 0);
  const Outcome again = program.run({"run", "small.yaml", "--hits", "--set", "workload={rays_from: rays.csv}", "--out",
                                     "b", "--set", "verify=reference"});
  ASSERT_EQ(again.status, 0) << again.err;
  const std::string hits = program.read("a/hits.csv");
  EXPECT_GT(hits.size(), 1000u);
  EXPECT_EQ(hits, program.read("b/hits.csv"));
  const Json report = Json::parse(program.read("b/report.json"));
  EXPECT_FALSE(report["digest"].contains("image"));
  EXPECT_FALSE(std::filesystem::exists(program.folder() / "b/image.png"));
}

TEST(RunCommand, FindsRayFilesBesideTheConfig) {
  const Program program;
  std::filesystem::create_directory(program.folder() / "sub");
  program.write("sub/rays.csv", "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n0,camera,0,0,0,0,0,1,0,inf\n");
  program.write("sub/list.yaml", "scene: {builtin: cornell}\nworkload: {rays_from: rays.csv}\n");
  EXPECT_EQ(program.run({"run", "sub/list.yaml", "--out", "o"}).status, 0);
  EXPECT_EQ(Json::parse(program.read("o/report.json"))["rays"]["emitted"], 1);
}

TEST(RunCommand, WrongInputsAreNamedAndEndWithStatus2) {
  const Program program;
  program.write("bad.yaml", "scene: {builtin: cornell}\nimage: {width: 0}\npackets: {size: 3}\n");
  Outcome outcome = program.run({"run", "bad.yaml"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("error: bad.yaml:2:16: image.width: expected an integer from 1 to 16384"));
  EXPECT_THAT(outcome.err, HasSubstr("error: bad.yaml:3:11: packets.size: unknown key"));
  EXPECT_THAT(outcome.out, IsEmpty());

  outcome = program.run({"run", "nothing.yaml"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("error: nothing.yaml: cannot be read"));

  program.write("small.yaml", kSmall);
  outcome = program.run({"run", "small.yaml", "--set", "scene={file: missing.glb}"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("missing.glb"));

  outcome = program.run({"run", "small.yaml", "--set", "scene.camera=7"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--set scene.camera=7: scene.camera:"));

  outcome = program.run({"run", "small.yaml", "--set", "collections.capacity=64"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--set collections.capacity=64: collections.capacity: expected at least"));

  program.write("rays.csv", "ray,kind\n");
  outcome = program.run({"run", "small.yaml", "--set", "workload={rays_from: rays.csv}"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("rays.csv:1:"));
}

TEST(RunCommand, FilesThatCannotBeWrittenEndWithStatus2) {
  const Program program;
  program.write("small.yaml", kSmall);
  program.write("file", "not a folder");
  const Outcome outcome = program.run({"run", "small.yaml", "--out", "file"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("error: cannot write file/"));
  EXPECT_EQ(program.run({"run", "small.yaml", "--dump-rays", "/dev/full"}).status, 2);
}

// Nothing bounds the packets on the way, and one thread fixes the order of steps: both resources fill their link
// before they look at what comes in (as in tests/ringbus/native/native_engine_test.cpp).
TEST(RunCommand, AStuckRunEndsWithStatus1AndSaysWhoWaits) {
  const Program program;
  program.write("stuck.yaml",
                "scene: {builtin: cornell}\nimage: {width: 32, height: 32}\nengine: {threads: 1}\n"
                "topology: {resources: 2, flow: none, link: {depth: 1}}\npackets: {rays: 1}\n"
                "collections: {ready: 1}\nshading: {workers: 1}\n");
  EXPECT_EQ(program.run({"run", "stuck.yaml"}).status, 2) << "only --force runs it";
  const Outcome outcome = program.run({"run", "stuck.yaml", "--force"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("error: no progress for 10000 ms"));
  EXPECT_THAT(outcome.err, HasSubstr("waits for a place in the link to resource 1"));
  EXPECT_FALSE(std::filesystem::exists(program.folder() / "out")) << "there is no result to report";
}

/// True if the process catches SIGINT by now: until then an interrupt just ends it.
bool catches_interrupts(pid_t pid) {
  std::ifstream in("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(in, line);)
    if (line.rfind("SigCgt:", 0) == 0) return std::stoull(line.substr(7), nullptr, 16) >> (SIGINT - 1) & 1;
  return false;
}

TEST(RunCommand, AnInterruptLeavesAPartialReport) {
  const Program program;
  program.write("long.yaml", "scene: {builtin: cornell}\nimage: {width: 256, height: 256, samples: 65536}\n");
  const pid_t pid = program.start({"run", "long.yaml"});
  for (int i = 0; i < 600 && !catches_interrupts(pid); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  kill(pid, SIGINT);
  const Outcome outcome = program.wait(pid);
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("INCOMPLETE"));
  const Json report = Json::parse(program.read("out/long/report.json"));
  EXPECT_EQ(report["incomplete"], true);
  EXPECT_EQ(schema_problems(report::report_schema(), report), std::vector<std::string>{});
}

}  // namespace
}  // namespace carousel::run_command_test
