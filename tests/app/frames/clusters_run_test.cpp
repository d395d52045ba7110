// Updates by clusters (`frames.update: clusters`) and a builder that asks an L2 (`frames.builder.asks: l2`), as a user
// runs them: against runs of each moment alone, against rebuilds, and against counts by hand.
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "report/run/report_json.h"
#include "tests/app/frames/series_program.h"
#include "tests/support/json_schema_check.h"

namespace carousel::clusters_run_test {
namespace {

/// Many small triangles in a cube, of which the first `moving` fly upwards within a second.
std::string flock(int triangles, int moving) {
  scene::GltfBuilder b;
  std::vector<float> positions, ways;
  std::uint32_t state = 1;
  const auto draw = [&] {
    state = state * 1664525u + 1013904223u;
    return static_cast<float>(state >> 8) / static_cast<float>(1 << 24);
  };
  for (int t = 0; t < triangles; ++t) {
    // In a row along x, so that those that move are neighbours.
    const float middle[3] = {4 * static_cast<float>(t) / static_cast<float>(triangles) - 2, draw() - 0.5f,
                             draw() - 0.5f};
    const float rise = t < moving ? 0.2f + draw() : 0.0f;
    for (int corner = 0; corner < 3; ++corner)
      for (int axis = 0; axis < 3; ++axis) {
        positions.push_back(middle[axis] + 0.1f * (draw() - 0.5f));
        ways.push_back(axis == 1 ? rise : 0.0f);
      }
  }
  const int at = b.floats(positions, "VEC3", 3), to = b.floats(ways, "VEC3", 3);
  b.mesh({{"POSITION", at}});
  b.json["meshes"][0]["primitives"][0]["targets"] = scene::GltfBuilder::Json::array({{{"POSITION", to}}});
  scene::animate(b, 0, "weights", {0, 1}, {0, 1}, "SCALAR", 1);
  return b.text();
}

const std::string kFlock = "{file: flock.gltf, time: 0}\ncamera: {eye: [0, 0, 5], target: [0, 0, 0]}";
const std::string kCycle = "engine.kind=cycle", kClusters = "frames.update=clusters";

class ClustersRun : public SeriesProgram {
 protected:
  Json second_row(const std::string& scene, std::vector<std::string> sets) const {
    sets.insert(sets.begin(), {kCycle, "frames.count=2"});
    return run(scene, sets)["frames"]["rows"][1];
  }
};

std::uint64_t bytes_of(const nlohmann::ordered_json& row) {
  return row["builder"]["bytes_read"].get<std::uint64_t>() + row["builder"]["bytes_written"].get<std::uint64_t>();
}

TEST_F(ClustersRun, EachFrameIsThatOfABuildFromNothing) {
  program_.write("flock.gltf", flock(600, 200));
  for (const std::string& scene : {kSwarm, kBalls, kWaves, kArm, kSquare, kFlock,
                                   std::string("{builtin: spheres, triangles: 2000, procedural: true}")}) {
    SCOPED_TRACE(scene);
    const std::vector<std::string> frames{"frames.count=4", "frames.step=0.3"};
    const auto with = [&](std::vector<std::string> more) {
      more.insert(more.begin(), frames.begin(), frames.end());
      return run(scene, more);
    };
    const Json anew = with({"engine.kind=native", "frames.update=rebuild"});
    std::vector<const char*> machines{"frames.cluster_primitives=8"};
    if (scene == kBalls) machines = {"bvh.storage=quantised", "frames.builder.local_primitives=64", "bvh.width=4"};
    for (const char* more : machines) {
      SCOPED_TRACE(more);
      const Json renewed = with({kCycle, kClusters, "verify=reference", more});
      EXPECT_THAT(schema_problems(report::report_schema(), renewed), testing::IsEmpty());
      EXPECT_EQ(renewed["verify"]["mismatches"], 0);
      EXPECT_EQ(renewed["frames"]["rows"][3]["update"], "clusters") << renewed["frames"]["rows"][3]["why"];
      EXPECT_EQ(digests(renewed), digests(anew));
    }
  }
}

// A mesh of two triangles in one leaf is a cluster. In memory: a node of 256 bytes, the leaf's block of 160 at 256,
// positions at 4096, the matrix at 8192, and of the cluster a bit, a record of 32 bytes in the line behind it, and
// behind the record two numbers. The bit's line, the numbers' and two of positions are read, the record and three lines
// of the leaf written; the top level is refitted as ever.
TEST_F(ClustersRun, TheBuilderMovesWhatAClusterNeeds) {
  const Json row = second_row("{builtin: terrain, triangles: 2}", {kClusters});
  const Json& update = row["builder"];
  EXPECT_EQ(update["bytes_read"], 64 * (1 + 1 + 2 + 4 + 1 + 3));
  EXPECT_EQ(update["bytes_written"], 64 * (1 + 3 + 4));
  EXPECT_EQ(update["top_bytes"], 64 * (4 + 1 + 3 + 4));
  EXPECT_EQ(update["levels"], 3);
  EXPECT_EQ(update["boxes"], 2 * 2 + 1 + 8);
  EXPECT_EQ(row["clusters"], Json({{"count", 1}, {"rebuilt", 1}, {"better", 0}, {"dealt_meshes", 0}, {"bytes", 41}}));
}

TEST_F(ClustersRun, ASmallPartThatMovesTakesATwentiethOfTheBytesOfARebuild) {
  program_.write("flock.gltf", flock(3000, 90));
  const Json row = second_row(kFlock, {kClusters, "frames.step=0.5"});
  EXPECT_EQ(row["update"], "clusters");
  EXPECT_GT(row["clusters"]["rebuilt"], 0);
  EXPECT_LT(10 * row["clusters"]["rebuilt"].get<int>(), row["clusters"]["count"].get<int>());
  const std::uint64_t rebuild = bytes_of(second_row(kFlock, {"frames.update=rebuild", "frames.step=0.5"}));
  EXPECT_EQ(row["rebuild_bytes"], rebuild);
  EXPECT_LT(20 * bytes_of(row), rebuild);
  EXPECT_LT(bytes_of(row), bytes_of(second_row(kFlock, {"frames.step=0.5"}))) << "a refit of the whole mesh";
  const Json above = second_row(kFlock, {kClusters, "frames.step=0.5", "frames.builder.local_primitives=64"});
  EXPECT_EQ(above["clusters"]["dealt_meshes"], 0) << "its clusters do not fit into the store";
  EXPECT_LT(15 * bytes_of(above), above["rebuild_bytes"].get<std::uint64_t>()) << "a rebuild in the same store";
  EXPECT_GT(bytes_of(above), bytes_of(row)) << "smaller tasks share fewer lines";
}

// Where nothing but the far end of the series matters: clusters are hung anew, and find better orders.
TEST_F(ClustersRun, AnOldTreeStaysAsGoodAsANewOne) {
  const auto worn = [&](const std::string& update) {
    const Json row = second_row("{builtin: spheres, triangles: 3000}", {update, "frames.step=4"});
    return row["depth_first_tests"].get<double>() / row["depth_first_tests_rebuilt"].get<double>();
  };
  const double clusters = worn(kClusters), refit = worn("frames.update=refit");
  EXPECT_LT(clusters, 1.2);
  EXPECT_LT(3 * clusters, refit);
}

TEST_F(ClustersRun, ABuilderThatAsksAnL2LeavesItsLinesThere) {
  program_.write("flock.gltf", flock(600, 200));
  for (const char* update : {"refit", "rebuild", "clusters"})
    for (const std::string& scene : {kSwarm, kFlock})
      for (const char* write : {"through", "back"}) {
        SCOPED_TRACE(fmt::format("{} {} {}", update, scene, write));
        const std::vector<std::string> sets{kCycle, "frames={count: 3, step: 0.2}",
                                            fmt::format("frames.update={}", update),
                                            fmt::format("memory.l2_write={}", write), "energy.profile=n7"};
        std::vector<std::string> asks = sets;
        asks.push_back("frames.builder.asks=l2");
        const Json memory = run(scene, sets), l2 = run(scene, asks);
        EXPECT_EQ(digests(l2), digests(memory));
        for (const int i : {1, 2}) {
          const Json &row = l2["frames"]["rows"][static_cast<std::size_t>(i)],
                     &other = memory["frames"]["rows"][static_cast<std::size_t>(i)];
          const Json& use = row["builder"]["l2"];
          EXPECT_EQ(use["lines"].get<std::uint64_t>() * 64, other["builder"]["bytes_read"]) << "it asks for the same";
          EXPECT_EQ(use["written"].get<std::uint64_t>() * 64, other["builder"]["bytes_written"]);
          EXPECT_LT(bytes_of(row), bytes_of(other)) << "lines that it asks for again are there";
          if (std::string(write) == "back") {
            EXPECT_GT(use["drained"], 0);
            EXPECT_LT(row["memory_bytes"], other["memory_bytes"]) << "rays find what it wrote";
          } else {
            EXPECT_EQ(use["drained"], 0);
            EXPECT_EQ(row["builder"]["bytes_written"], other["builder"]["bytes_written"]);
          }
          EXPECT_GT(row["builder"]["joules"].get<double>(), 0);
        }
      }
}

// All of the structure is in the L2, from the frame before. The positions, 36 bytes each, lie behind it from a page's
// border on, and others have written all of them.
TEST_F(ClustersRun, VerticesThatMovedAreReadAnew) {
  const Json report =
      run(kWaves, {kCycle, "frames={count: 3, step: 0.2, builder: {asks: l2}}", "memory.l2_write=back"});
  const std::uint64_t triangles = report["scene"]["triangles"];
  for (const int i : {1, 2}) {
    const Json& update = report["frames"]["rows"][static_cast<std::size_t>(i)]["builder"];
    EXPECT_GE(update["bytes_read"], triangles * 36) << i;
  }
  EXPECT_GT(report["frames"]["rows"][2]["builder"]["lines_dropped"], 0);
  EXPECT_EQ(report["frames"]["rows"][2]["builder"]["bytes_read"], (triangles * 36 + 63) / 64 * 64);
}

// Beside what TheBuilderHasAnAreaAndItsStoreTakesEnergy has: 64 bits of a bank of the L2, of 512 KiB, take 20 pJ x
// 5^(log KiB/32 / log 32). It is read or written for each line that is asked for, written or fetched.
TEST_F(ClustersRun, AnL2ThatTheBuilderAsksTakesTheEnergyOfABank) {
  const auto access = [](double kib) { return 20 * std::pow(5, std::log(kib / 32) / std::log(32)); };
  for (const int banks : {1, 4}) {
    const Json update = second_row(kWaves, {kClusters, "frames.step=0.2", "frames.builder.asks=l2",
                                            "energy.profile=n45", fmt::format("memory.l2_banks={}", banks)})["builder"];
    const double bytes = 64 * (update["l2"]["lines"].get<double>() + update["l2"]["written"].get<double>()),
                 fetched = update["bytes_read"], boxes = update["boxes"];
    EXPECT_NEAR(update["joules"].get<double>(),
                1e-12 * (244 * (fetched + update["bytes_written"].get<double>()) + 28.6 * boxes +
                         (access(36) * (bytes + 32 * boxes) + access(512.0 / banks) * (bytes + fetched)) / 8),
                1e-13)
        << banks;
  }
}

// Each line that the L2 asks of the memory, or writes there, looks its page up in a TLB of 64 entries of 16 bytes, a
// word, and a walk writes one. A walk reads four lines of the page table for an address of 48 bits, past the L2.
TEST_F(ClustersRun, ItsPagesTakeTheEnergyOfATlb) {
  const auto update = [&](const char* pages) {
    return second_row(kWaves,
                      {kClusters, "frames.step=0.2", "frames.builder.asks=l2", "energy.profile=n45", pages})["builder"];
  };
  const Json without = update("memory.translation.page_bytes=0"),
             with = update("memory.translation={page_bytes: 4096, entries: 64}");
  const double moved = without["bytes_read"].get<double>() + without["bytes_written"].get<double>(),
               walked = with["bytes_read"].get<double>() - without["bytes_read"].get<double>();
  ASSERT_GT(walked, 0);
  EXPECT_EQ(with["l2"], without["l2"]);
  EXPECT_EQ(with["bytes_written"], without["bytes_written"]);
  const double access = 10 * std::pow(2, std::log(1.0 / 8) / std::log(4));  // of 1 KiB: 8 take 10 pJ, and 32 twice that
  EXPECT_NEAR(with["joules"].get<double>() - without["joules"].get<double>(),
              1e-12 * (244 * walked + access * (moved / 64 + walked / 64 / 4)), 1e-14);
}

TEST_F(ClustersRun, RefusesWhatDoesNotFit) {
  const auto no = [&](const std::string& set, const std::string& message) {
    refused(kWaves, {"frames.count=2", kClusters, set}, message);
  };
  no("bvh.treelets.bytes=4096", "bvh.treelets.bytes: an update of clusters hangs them below other nodes");
  no("bvh.mixed_triangles=4", "bvh.mixed_triangles: an update of clusters hangs leaves below other nodes");
  no("bvh.micromaps.states=two", "bvh.micromaps.states: an update of clusters puts primitives into other leaves");
  no("bvh.builder=spatial", "bvh.builder: the builder of the machine divides meshes by their triangles");
  no("frames={update: clusters, count: 2, cluster_primitives: 64, builder: {local_primitives: 63}}",
     "frames.cluster_primitives: a cluster is built in the builder's store; expected at most "
     "frames.builder.local_primitives, which are 63, found 64");
  no("frames.cluster_primitives=0", "frames.cluster_primitives: expected auto or an integer from 1");
  refused(kWaves, {"frames.count=2", "frames.builder.asks=l1"},
          "frames.builder.asks: expected one of memory, l2, found 'l1'");
  const Outcome idle =
      program_.run({"check", "series.yaml", "--set", "frames.count=2", "--set", "frames.cluster_primitives=9"});
  EXPECT_THAT(idle.err + idle.out, testing::HasSubstr("frames.update chooses no clusters"));
  const Outcome alone = program_.run(
      {"check", "series.yaml", "--set", "frames={update: clusters, count: 1}", "--set", "frames.cluster_primitives=9"});
  EXPECT_THAT(alone.err + alone.out,
              testing::HasSubstr("frames.cluster_primitives, frames.update (there is one frame)"));
}

}  // namespace
}  // namespace carousel::clusters_run_test
