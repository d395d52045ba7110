// Files that the program writes are files that it reads: the configuration of a run from any folder, and the lists of
// its rays, hits and memory requests.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "tests/app/support/program.h"

namespace carousel::run_again_test {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

/// The triangle (0, 0, 0), (1, 0, 0), (0, 1, 0).
constexpr const char* kTriangle =
    R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}],
"buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]})";

/// A folder `in` with files, and configurations that name them relative to it.
void add_configs(const Program& program) {
  std::filesystem::create_directory(program.folder() / "in");
  program.write("in/triangle.gltf", kTriangle);
  program.write("in/rays.csv", "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n0,camera,0.25,0.25,1,0,0,-1,0,inf\n");
  program.write("in/memory.csv", "cycle,kind,address,bytes\n0,read,0,64\n5,write,64,64\n");
  program.write("in/picture.yaml", "scene: {file: triangle.gltf}\nimage: {width: 8, height: 8, samples: 1}\n");
  program.write("in/list.yaml", "scene: {file: triangle.gltf}\nworkload: {rays_from: rays.csv}\n");
  program.write("in/memory.yaml", "engine: {kind: cycle}\nworkload: {memory_trace: memory.csv}\n");
  program.write("in/list.json", R"({"scene": {"file": "triangle.gltf"}, "workload": {"rays_from": "rays.csv"}})");
}

TEST(RunAgain, WrittenConfigurationsRunFromAnyFolder) {
  const Program program, elsewhere;
  add_configs(program);
  for (const std::string name : {"picture.yaml", "list.yaml", "list.json", "memory.yaml"}) {
    SCOPED_TRACE(name);
    const Outcome first = program.run({"run", "in/" + name, "--out", "out/" + name, "--quiet"});
    ASSERT_EQ(first.status, 0) << first.err;
    const std::string written = (program.folder() / "out" / name / "config.resolved.yaml").string();
    const Outcome again = elsewhere.run({"run", written, "--out", name, "--quiet"});
    ASSERT_EQ(again.status, 0) << again.err;
    const Json run = Json::parse(program.read("out/" + name + "/report.json"));
    const Json rerun = Json::parse(elsewhere.read(name + "/report.json"));
    EXPECT_EQ(rerun["digest"], run["digest"]);
    EXPECT_EQ(rerun["rays"], run["rays"]);
    EXPECT_EQ(rerun.value("memory_trace", Json()), run.value("memory_trace", Json()));
    EXPECT_EQ(elsewhere.read(name + "/config.resolved.yaml"), program.read("out/" + name + "/config.resolved.yaml"));
    // A report's page offers the report's own configuration as a file.
    elsewhere.write("page.json", run["config"].dump());
    EXPECT_EQ(elsewhere.run({"run", "page.json", "--out", name, "--quiet"}).status, 0);
    EXPECT_EQ(program.run({"run", "in/" + name, "--out", "out/" + name, "--quiet"}).status, 0);
  }
}

TEST(RunAgain, RunsInTwoFoldersAreCompared) {
  const Program one, other, elsewhere;
  add_configs(one);
  add_configs(other);
  const auto run = [](const Program& program, const char* out, const char* machine) {
    return program
        .run({"run", "in/list.yaml", "--set", "engine={kind: cycle, what_if: false}", "--set", machine, "--out", out,
              "--quiet"})
        .status;
  };
  ASSERT_EQ(run(one, "a", "topology.link.latency_cycles=3"), 0);
  ASSERT_EQ(run(one, "b", "topology.link.latency_cycles=5"), 0);
  ASSERT_EQ(run(other, "a", "topology.link.latency_cycles=3"), 0);
  const auto path = [](const Program& program, const char* out) { return (program.folder() / out).string(); };
  const Outcome same = elsewhere.run({"compare", path(one, "a"), path(other, "a"), "--expect", "identical"});
  EXPECT_EQ(same.status, 0) << same.out;
  ASSERT_EQ(elsewhere.run({"run", path(one, "a/config.resolved.yaml"), "--out", "again", "--quiet"}).status, 0);
  const Outcome again = elsewhere.run({"compare", path(one, "a"), "again", "--expect", "identical"});
  EXPECT_EQ(again.status, 0) << again.out;
  // Both run a second time, to find where they part.
  const Outcome parted = elsewhere.run({"compare", path(one, "a"), path(one, "b"), "--all"});
  EXPECT_EQ(parted.status, 0) << parted.err;
  EXPECT_THAT(parted.out, HasSubstr("first divergence"));
}

TEST(RunAgain, OtherCommandsWriteConfigurationsThatRunToo) {
  const Program program, elsewhere;
  add_configs(program);
  elsewhere.write("checked.yaml", program.run({"check", "in/list.yaml"}).out);
  const Outcome checked = elsewhere.run({"check", "checked.yaml"});
  EXPECT_EQ(checked.status, 0) << checked.err;
  EXPECT_THAT(checked.out, HasSubstr("# rays: 1 of " + program.folder().string()));
  ASSERT_EQ(program
                .run({"stress", "in/picture.yaml", "--in", "topology.link.queue", "--seconds", "0.01", "--depths", "4",
                      "--out", "out", "--quiet"})
                .status,
            0);
  const auto check = [&] {
    const Outcome again = elsewhere.run({"check", (program.folder() / "out/config.resolved.yaml").string()});
    EXPECT_EQ(again.status, 0) << again.err;
  };
  check();
  const Outcome accuracy = program.run({"accuracy", "in/picture.yaml", "--rays", "20", "--hard-rays", "20",
                                        "--repetitions", "1", "--out", "out", "--force", "--quiet"});
  ASSERT_EQ(accuracy.status, 0) << accuracy.err;
  check();
}

TEST(RunAgain, HitsAreAListOfRays) {
  const Program program;
  program.write("a.yaml",
                "scene: {builtin: cornell}\nimage: {width: 12, height: 9, samples: 1}\ntopology: {resources: 4}\n");
  ASSERT_EQ(program.run({"run", "a.yaml", "--hits", "--out", "a", "--quiet"}).status, 0);
  const Outcome again =
      program.run({"run", "a.yaml", "--hits", "--set", "workload={rays_from: a/hits.csv}", "--out", "b", "--quiet"});
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(program.read("b/hits.csv"), program.read("a/hits.csv"));
}

/// Records of rays, states of paths and the film have places of their own in the simulated memory.
// Others reported this kind of fault: ramulator2 51, 88.
TEST(RunAgain, RequestsToMemoryPlayWhateverIsInMemory) {
  const Program program;
  program.write("a.yaml",
                "scene: {builtin: terrain, triangles: 500}\nimage: {width: 12, height: 8, samples: 1, max_depth: 3}\n"
                "engine: {kind: cycle, threads: 1, what_if: false}\ntopology: {resources: 4}\n"
                "rays: {slots_per_resource: 32}\ncollections: {ready: 8, capacity: 16384}\n");
  for (const std::string memory : {"path_state: memory", "film: memory", "ray_records: master",
                                   "path_state: memory, film: memory, "
                                   "ray_records: master, l2_write: back, dram: {preset: gddr6_14}"}) {
    SCOPED_TRACE(memory);
    const std::string section = "memory={l2_kib: 4, " + memory + "}";
    const Outcome outcome = program.run(
        {"run", "a.yaml", "--set", section, "--dump-memory", "memory.csv", "--out", "a", "--force", "--quiet"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const Outcome played = program.run({"run", "a.yaml", "--set", section, "--set",
                                        "workload={memory_trace: memory.csv}", "--out", "b", "--force", "--quiet"});
    ASSERT_EQ(played.status, 0) << played.err;
    const Json run = Json::parse(program.read("a/report.json"))["memory"];
    const Json trace = Json::parse(program.read("b/report.json"))["memory_trace"];
    EXPECT_EQ(trace["reads"], run["dram_lines"]);
    EXPECT_EQ(trace["writes"], run["dram_lines_written"]);
    EXPECT_GT(trace["writes"], 0);
    if (!run.contains("dram")) continue;
    for (std::size_t c = 0; c < run["dram"]["channels"].size(); ++c)
      for (const char* key : {"reads", "writes", "row_hits", "row_misses", "row_conflicts"})
        EXPECT_EQ(trace["dram"]["channels"][c][key], run["dram"]["channels"][c][key]) << key;
  }
}

/// Devices and files of other kinds have no ends of lines, and may have no end.
TEST(EndlessInput, IsRefusedAtOnce) {
  const Program program;
  program.write("rays.yaml", "scene: {builtin: cornell}\nworkload: {rays_from: /dev/zero}\n");
  program.write("memory.yaml", "engine: {kind: cycle}\nworkload: {memory_trace: /dev/zero}\n");
  for (const char* command : {"check", "run"}) {
    EXPECT_THAT(program.run({command, "rays.yaml"}).err,
                HasSubstr("/dev/zero:1: expected a line of CSV, found one of more than 4096 bytes"));
    const Outcome memory = program.run({command, "memory.yaml"});
    EXPECT_EQ(memory.status, 2);
    EXPECT_THAT(memory.err, HasSubstr("/dev/zero:1: expected a line of CSV, found one of more than 256 bytes"));
  }
  const Outcome sweep = program.run({"sweep", "rays.yaml", "--vary", "topology.resources=1,2", "--quiet"});
  EXPECT_NE(sweep.status, 0);
  EXPECT_THAT(sweep.err, HasSubstr("cannot read /dev/zero: expected a plain file"));
  // Each point would read the pipe again, and no writer need ever come.
  ASSERT_EQ(mkfifo((program.folder() / "pipe").c_str(), 0600), 0);
  program.write("pipe.yaml", "scene: {builtin: cornell}\nworkload: {rays_from: pipe}\n");
  const Outcome pipe = program.run({"sweep", "pipe.yaml", "--vary", "topology.resources=1,2", "--quiet"});
  EXPECT_EQ(pipe.status, 2);
  EXPECT_THAT(pipe.err, HasSubstr("pipe: expected a plain file, found a pipe"));
  EXPECT_THAT(program.run({"check", "/dev/zero"}).err, HasSubstr("/dev/zero"));
}

}  // namespace
}  // namespace carousel::run_again_test
