// Series of frames as a user runs them. Each frame is held against a run of that moment alone, whose structure is built
// from nothing, and against the reference tracer.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/run/report_json.h"
#include "tests/app/frames/series_program.h"
#include "tests/support/json_schema_check.h"

namespace carousel::frames_run_test {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

class FramesRun : public SeriesProgram {};

TEST_F(FramesRun, EachFrameIsThatOfABuildFromNothing) {
  for (const std::string& scene : {kSwarm, kBalls, kWaves, kArm, kSquare}) {
    SCOPED_TRACE(scene);
    const std::string frames = "frames.count=4", step = "frames.step=0.3", cycle = "engine.kind=cycle";
    const Json refit = run(scene, {frames, step, cycle, "verify=reference"});
    EXPECT_EQ(refit["verify"]["mismatches"], 0);
    EXPECT_EQ(refit["verify"]["compared"], refit["frames"]["rays"]);
    ASSERT_EQ(refit["frames"]["rows"].size(), 4u);
    EXPECT_EQ(refit["frames"]["rows"][0]["update"], "built");
    EXPECT_EQ(refit["frames"]["rows"][3]["update"], "refit") << refit["frames"]["rows"][3]["why"];
    EXPECT_NE(refit["frames"]["rows"][0]["digest"]["hits"], refit["frames"]["rows"][3]["digest"]["hits"]) << "it moves";
    EXPECT_EQ(digests(refit), digests(run(scene, {frames, step, "engine.kind=native", "frames.update=rebuild"})));
    const Json& row = refit["frames"]["rows"][2];
    EXPECT_EQ(run(scene, {fmt::format("scene.time={}", row["time"].dump()), cycle})["digest"], row["digest"]);
    if (scene != kBalls) continue;
    EXPECT_EQ(digests(refit), digests(run(scene, {frames, step, "bvh.storage=quantised"})));
    EXPECT_EQ(run(scene, {"frames={first: 3, count: 1, step: 0.3}"})["digest"], refit["frames"]["rows"][3]["digest"]);
  }
}

TEST_F(FramesRun, ThirtyFramesOfASwarmCloseTheirTotals) {
  const Json report = run(kSwarm, {"frames.count=30", "engine.kind=cycle", "energy.profile=n7"});
  EXPECT_THAT(schema_problems(report::report_schema(), report), testing::IsEmpty());
  const Json& frames = report["frames"];
  ASSERT_EQ(frames["rows"].size(), 30u);
  std::uint64_t cycles = 0, builder = 0, bytes = 0, rays = 0, limited = 0, worn = 0;
  for (const Json& row : frames["rows"]) {
    const std::uint64_t own = row["cycles"];
    cycles += own;
    rays += row["rays"].get<std::uint64_t>();
    if (!row.contains("builder")) continue;
    const Json& update = row["builder"];
    builder += update["cycles"].get<std::uint64_t>();
    bytes += update["bytes_read"].get<std::uint64_t>() + update["bytes_written"].get<std::uint64_t>();
    limited += update["cycles"].get<std::uint64_t>() > own;
    worn += row["rebuild_pays"].get<bool>();
    EXPECT_GT(update["joules"].get<double>(), 0);
    EXPECT_EQ(update["top_bytes"],
              update["bytes_read"].get<std::uint64_t>() + update["bytes_written"].get<std::uint64_t>())
        << "no mesh changes";
  }
  EXPECT_FALSE(frames["rows"][0].contains("builder"));
  EXPECT_TRUE(frames["rows"][1].contains("builder"));
  EXPECT_EQ(frames["cycles"], cycles + builder);
  EXPECT_EQ(frames["builder_cycles"], builder);
  EXPECT_EQ(frames["builder_bytes"], bytes);
  EXPECT_EQ(frames["rays"], rays);
  EXPECT_EQ(frames["limited_by_builder"], limited);
  EXPECT_EQ(frames["worn"], worn);
  EXPECT_EQ(report["digest"], frames["rows"][29]["digest"]) << "the rest of the report is that of the last frame";
}

TEST_F(FramesRun, ThirtyFramesOfASkinAndOfASwarmHaveTheHitsOfBuildsFromNothing) {
  for (const std::string& scene : {kArm, kSwarm}) {
    const Json anew = run(scene, {"frames.count=30", "engine.kind=native", "frames.update=rebuild"});
    ASSERT_EQ(anew["frames"]["rows"].size(), 30u);
    EXPECT_NE(digests(anew).front(), digests(anew)[20]) << "it moves";
    for (const char* update : {"refit", "clusters", "rebuild"}) {
      SCOPED_TRACE(scene + " " + update);
      const Json report = run(
          scene, {"frames.count=30", "engine.kind=cycle", std::string("frames.update=") + update, "verify=reference"});
      EXPECT_EQ(digests(report), digests(anew));
      const Json& frames = report["frames"];
      EXPECT_EQ(report["verify"]["mismatches"], 0);
      EXPECT_EQ(report["verify"]["compared"], frames["rays"]);
      std::uint64_t cycles = 0, bytes = 0, rays = 0, updates = 0;
      for (const Json& row : frames["rows"]) {
        cycles += row["cycles"].get<std::uint64_t>();
        rays += row["rays"].get<std::uint64_t>();
        if (!row.contains("builder")) continue;
        ++updates;
        EXPECT_EQ(row["update"], update) << row["why"];
        cycles += row["builder"]["cycles"].get<std::uint64_t>();
        bytes +=
            row["builder"]["bytes_read"].get<std::uint64_t>() + row["builder"]["bytes_written"].get<std::uint64_t>();
      }
      EXPECT_GE(updates, 24u);  // the arm stops after a second
      EXPECT_EQ(frames["cycles"], cycles);
      EXPECT_EQ(frames["builder_bytes"], bytes);
      EXPECT_EQ(frames["rays"], rays);
    }
    for (const std::size_t frame : {7u, 20u}) {
      const Json& row = anew["frames"]["rows"][frame];
      EXPECT_EQ(run(scene, {"scene.time=" + row["time"].dump(), "engine.kind=cycle"})["digest"], row["digest"])
          << frame;
    }
  }
}

// Two triangles in one leaf. In memory: a node of 256 bytes; the leaf's block of 160 at 256; positions of 36 bytes a
// triangle at 4096; the matrix at 8192. Lines have 64 bytes. The leaf reads 3 and 2 lines, the node 4, 1 and 3.
TEST_F(FramesRun, TheBuilderMovesWhatARefitNeeds) {
  const std::string scene = "{builtin: terrain, triangles: 2}";
  const Json report = run(scene, {"frames.count=2", "engine.kind=cycle"});
  const Json& update = report["frames"]["rows"][1]["builder"];
  EXPECT_EQ(update["bytes_read"], 64 * (3 + 2 + 4 + 1 + 3));
  EXPECT_EQ(update["bytes_written"], 64 * (3 + 4));
  EXPECT_EQ(update["top_bytes"], 64 * (4 + 1 + 3 + 4));
  EXPECT_EQ(update["levels"], 2);
  EXPECT_EQ(update["boxes"], 2 + 1 + 8);
  const auto cycles = [&](const std::string& set) {
    const Json other = run(scene, {"frames.count=2", "engine.kind=cycle", set});
    EXPECT_EQ(other["frames"]["rows"][1]["builder"]["bytes_read"], update["bytes_read"]);
    return other["frames"]["rows"][1]["builder"]["cycles"].get<std::uint64_t>();
  };
  EXPECT_GE(update["cycles"].get<std::uint64_t>(), 2 * 200 + 2 + 9) << "each level waits for the memory and its boxes";
  EXPECT_GT(cycles("frames.builder.requests=1"), 13 * 200) << "one line at a time";
  EXPECT_GE(cycles("frames.builder.bytes_per_cycle=1"), 64 * (13 + 7) - 64) << "its port is the limit";
  EXPECT_GT(cycles("memory.dram_latency_cycles=2000"), 2 * 2000);
  EXPECT_EQ(cycles("frames.builder.latency_cycles=100"), update["cycles"].get<std::uint64_t>() + 2 * (100 - 4))
      << "once a level";
}

// A box unit has 0.126 mm2 and a KiB 0.00456 at 45 nm. The store has 1,024 records of 32 bytes and 64 lines of 64
// bytes: 36 KiB, of which 64 bits take 20 pJ x 5^(log 36/32 / log 32). A byte of the memory is 244 pJ, and a box 29 pJ.
TEST_F(FramesRun, TheBuilderHasAnAreaAndItsStoreTakesEnergy) {
  const Json r = run("{builtin: terrain, triangles: 2}",
                     {"frames.count=2", "engine.kind=cycle", "energy.profile=n45", "frames.builder.boxes_per_cycle=3"});
  EXPECT_EQ(r["area"]["parts"]["builder"]["size"], 36);
  EXPECT_NEAR(r["area"]["parts"]["builder"]["mm2"].get<double>(), 36 * 0.00456 + 3 * 0.126, 1e-5);
  const Json& update = r["frames"]["rows"][1]["builder"];
  const double bytes = 64.0 * (13 + 7), boxes = update["boxes"],
               access = 20 * std::pow(5, std::log(36.0 / 32) / std::log(32));
  EXPECT_NEAR(update["joules"].get<double>(), 1e-12 * (244 * bytes + 28.6 * boxes + access * (bytes + 32 * boxes) / 8),
              1e-13);
  EXPECT_EQ(run("{builtin: terrain, triangles: 2}",
                {"engine.kind=cycle", "energy.profile=n45"})["area"]["parts"]["builder"]["mm2"],
            0);
}

TEST_F(FramesRun, ARebuildMovesMoreThanARefit) {
  const auto bytes = [&](const std::vector<std::string>& more) {
    std::vector<std::string> sets{"frames.count=2", "engine.kind=cycle"};
    sets.insert(sets.end(), more.begin(), more.end());
    return run(kWaves, sets)["frames"]["builder_bytes"].get<std::uint64_t>();
  };
  const std::uint64_t rebuilt = bytes({"frames.update=rebuild"});
  EXPECT_GT(bytes({"frames.update=rebuild", "frames.builder.local_primitives=1"}), rebuilt);
  EXPECT_GT(bytes({"frames.update=rebuild", "frames.builder.local_primitives=16"}), bytes({}));
}

// The second series has the answer that the first one gives: that of a rebuild in the last frame.
TEST_F(FramesRun, AnOldTreeWearsOutAndIsFoundSo) {
  const std::vector<std::string> slow{"frames={count: 2, step: 4}", "engine.kind=cycle", "image.width=32",
                                      "image.height=24", "memory.dram_latency_cycles=20"};
  std::vector<std::string> fast = slow;
  fast.insert(fast.end(), {"memory.dram_bytes_per_cycle=1024", "frames.builder.bytes_per_cycle=4096",
                           "frames.builder.boxes_per_cycle=1024", "frames.builder.requests=4096"});
  for (const auto& [sets, pays] : {std::pair(slow, false), std::pair(fast, true)}) {
    std::vector<std::string> anew = sets;
    anew.push_back("frames.update=rebuild");
    const Json last = run(kBalls, sets)["frames"]["rows"][1], rebuilt = run(kBalls, anew)["frames"]["rows"][1];
    EXPECT_GT(last["surface_cost"].get<double>(), last["surface_cost_rebuilt"].get<double>());
    EXPECT_EQ(last["surface_cost_rebuilt"], rebuilt["surface_cost"]);
    EXPECT_GT(last["depth_first_tests"].get<double>(), 1.5 * last["depth_first_tests_rebuilt"].get<double>());
    EXPECT_EQ(last["rebuild_cycles"], rebuilt["builder"]["cycles"]);
    ASSERT_TRUE(last.contains("cycles_rebuilt"));
    EXPECT_EQ(last["cycles_rebuilt"], rebuilt["cycles"]);
    EXPECT_EQ(last["rebuild_pays"], pays);
    const auto sum = [](const Json& a, const Json& b) { return a.get<std::uint64_t>() + b.get<std::uint64_t>(); };
    EXPECT_EQ(sum(rebuilt["builder"]["cycles"], rebuilt["cycles"]) < sum(last["builder"]["cycles"], last["cycles"]),
              pays);
  }
}

// Units that trace their own rays take the tests of the depth-first tracer in the refitted structure.
TEST_F(FramesRun, ARefittedTreeIsVisitedAsOftenAsOutsideTheMachine) {
  const Json report = run(kBalls, {"frames={count: 3, step: 1}", "engine.kind=cycle", "topology.shape=independent"});
  for (const int i : {1, 2}) {
    const Json& row = report["frames"]["rows"][static_cast<std::size_t>(i)];
    const double tests = row["depth_first_tests"];
    EXPECT_NEAR(row["box_tests"].get<double>() + row["primitive_tests"].get<double>(), tests, 0.01 * tests);
  }
}

// A refit rounds boxes to as many bits as the build: boxes of 12 bits fit more closely than those of 8.
TEST_F(FramesRun, ARefitKeepsTheBitsOfAPlane) {
  const auto tests_of = [&](const std::string& storage) {
    const Json report = run(kBalls, {"frames={count: 2, step: 0.2}", "engine.kind=cycle", "bvh.storage=" + storage});
    EXPECT_EQ(report["frames"]["rows"][1]["update"], "refit");
    return report["frames"]["rows"][1]["depth_first_tests"].get<std::uint64_t>();
  };
  EXPECT_LT(tests_of("quantised_12"), tests_of("quantised"));
}

// Where nothing moves the second frame finds all of the structure in the caches. Where a part moves, lines leave them.
TEST_F(FramesRun, CachesStayWarm) {
  const Json still = run(kWaves, {"frames={count: 2, step: 0, update: none}", "engine.kind=cycle"});
  EXPECT_GT(still["frames"]["rows"][0]["memory_bytes"], 0);
  EXPECT_EQ(still["frames"]["rows"][1]["memory_bytes"], 0);
  EXPECT_LT(still["frames"]["rows"][1]["cycles"], still["frames"]["rows"][0]["cycles"]);
  EXPECT_EQ(still["frames"]["rows"][1]["update"], "kept");
  const Json waves = run(kWaves, {"frames.count=2", "engine.kind=cycle"});
  EXPECT_GT(waves["frames"]["rows"][1]["builder"]["lines_dropped"], 0);
  EXPECT_GT(waves["frames"]["rows"][1]["memory_bytes"], 0);
  const Json swarm = run(kSwarm, {"frames={count: 2, step: 0.001}", "engine.kind=cycle"});
  EXPECT_GT(swarm["frames"]["rows"][1]["memory_bytes"], 0);
  EXPECT_LT(2 * swarm["frames"]["rows"][1]["memory_bytes"].get<std::uint64_t>(),
            swarm["frames"]["rows"][0]["memory_bytes"].get<std::uint64_t>())
      << "the meshes stay in the caches";
}

TEST_F(FramesRun, WritesAPictureAFrame) {
  const auto there = [&](const std::string& name) { return std::filesystem::exists(program_.folder() / "out" / name); };
  run(kWaves, {"frames={count: 3, first: 5, step: 0.5}", "image.files=[png, exr]"});
  for (const char* name : {"image.0005.png", "image.0006.exr", "image.0007.png"}) EXPECT_TRUE(there(name)) << name;
  EXPECT_FALSE(there("image.0008.png"));
  EXPECT_EQ(program_.read("out/image.png"), program_.read("out/image.0007.png"));
  EXPECT_NE(program_.read("out/image.png"), program_.read("out/image.0005.png"));
  run(kWaves, {"frames={count: 2, first: 6, step: 0.5}", "image.files=[png]"});
  EXPECT_FALSE(there("image.0005.png")) << "the pictures of an earlier run go";
  EXPECT_TRUE(there("image.0006.png"));
}

TEST_F(FramesRun, ASceneThatNoRefitFitsIsRebuilt) {
  scene::GltfBuilder b = scene::GltfBuilder::square();
  b.node({{"mesh", 0}, {"translation", {2, 0, 0}}});
  scene::animate(b, 1, "scale", {0, 1}, {1, 1, 1, 0, 0, 0}, "VEC3", 3);
  program_.write("shrinks.gltf", b.text());
  const std::string scene = "{file: shrinks.gltf, time: 0}\ncamera: {eye: [1, 2, 5], target: [0, 0, 0]}";
  const Json report = run(scene, {"frames={count: 3, step: 0.5}", "engine.kind=cycle", "verify=reference"});
  EXPECT_EQ(report["verify"]["mismatches"], 0);
  EXPECT_EQ(report["frames"]["rows"][1]["update"], "refit") << report["frames"]["rows"][1]["why"];
  EXPECT_EQ(report["frames"]["rows"][2]["update"], "rebuild");
  EXPECT_THAT(report["frames"]["rows"][2]["why"].get<std::string>(), HasSubstr("singular"));
}

TEST_F(FramesRun, RefusesWhatDoesNotFit) {
  refused("{builtin: cornell}", {"frames.count=2"}, "frames: the built-in scene cornell does not move");
  refused("{file: arm.gltf}", {"frames.count=2"}, "scene.time: a series of a file begins at a moment");
  refused(kArm, {"frames={count: 2, step: 0.5, update: none}"}, "frames.update: in frame 1, at 0.5 s, mesh 0 (");
  refused(kWaves, {"frames={count: 2, update: none}"}, "frames.update: the built-in scene terrain moves");
  refused(kWaves, {"frames.count=0"}, "frames.count: expected an integer from 1");
  refused(kWaves, {"frames.cuont=2"}, "frames.cuont: unknown key; did you mean 'count'?");
  refused(kWaves, {"frames={count: 2, update: refits}"}, "did you mean");
  refused(kWaves, {"frames.count=2", "cull_planes.count=2"}, "cull_planes.count: cull planes are not updated yet");
  refused(kWaves, {"frames.count=2", "bvh.elements=spheres"}, "bvh.elements: an update computes boxes");
  refused(kWaves, {"frames.count=2", "sampling.fraction=0.5"}, "sampling.fraction: a series shows whole frames");
  refused("{builtin: instances, instances: 40, levels: 3}", {"frames.count=2"}, "scene.levels: groups of the built-in");
  program_.write("series.yaml", "scene: " + kWaves + "\n" + kMachine + "frames:\n  count: 2\n");
  const Outcome hits = program_.run({"run", "series.yaml", "--hits", "--out", "other"});
  EXPECT_EQ(hits.status, 2);
  EXPECT_THAT(hits.err, HasSubstr("--hits: a series shows 2 frames, and this is of one"));
  EXPECT_FALSE(std::filesystem::exists(program_.folder() / "other"));
  const Outcome versus = program_.run({"versus", "series.yaml", "--out", "other"});
  EXPECT_EQ(versus.status, 2);
  EXPECT_THAT(versus.err, HasSubstr("series.yaml:9:10: frames.count: a series is for carousel run only"));
  EXPECT_EQ(program_.run({"check", "series.yaml"}).status, 0);
}

}  // namespace
}  // namespace carousel::frames_run_test
