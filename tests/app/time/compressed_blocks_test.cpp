// Leaves in compressed blocks (`bvh.leaves: blocks`), on machines that are read from files: hits are those of every
// other storage of the same grid, and blocks are read, carried and decoded as what they are.
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::compressed_blocks_test {
namespace {

class CompressedBlocks : public TimedRun {
 protected:
  static Json digest(const Json& report) { return report["digest"]; }
  static std::uint64_t decoded(const Json& report) { return report["tests"]["decoded"]["count"]; }
};

const std::string kSmall = "image: {width: 16, height: 12, samples: 1, max_depth: 2}\ntopology: {resources: 4}\n";

// A ray each way through every machine: the decoder is in front of the triangle units of all of them.
TEST_F(CompressedBlocks, AreHitAsTheTrianglesOfTheGrid) {
  const std::vector<std::vector<std::string>> machines{
      {},
      {"packets.carry=data", "memory.fetch=packet"},
      {"collections.traversal=treelet"},
      {"collections.traversal=ordered", "collections.key=block"},
      {"topology.shape=independent"},
      {"topology.shape=independent", "testers.simt.warp=8"},
      {"topology.shape=central", "topology.resources=1", "testers.simd.lanes=8"},
      {"bundles.size=8"},
  };
  for (const char* scene : {"builtin: terrain, triangles: 2000", "builtin: instances, triangles: 300, instances: 12"}) {
    const std::string machine = fmt::format("scene: {{{}, quantise: 12}}\n", scene) + kSmall;
    const Json expected = digest(report(machine));
    EXPECT_EQ(digest(report(machine, {"engine.kind=native"})), expected);
    EXPECT_NE(digest(report(machine, {"scene.quantise=0"})), expected);
    for (std::vector<std::string> sets : machines) {
      const std::string name = sets.empty() ? "ring" : sets[0];
      sets.insert(sets.end(), {"bvh.leaves=blocks", "bvh.storage=quantised_12", "verify=reference"});
      const Json blocks = report(machine, sets);
      EXPECT_EQ(digest(blocks), expected) << name;
      EXPECT_EQ(blocks["verify"]["mismatches"], 0u) << name;
      EXPECT_GT(decoded(blocks), 0u) << name;
    }
  }
}

// One ray and one leaf: the decoder has to have it before triangles are tested, and the transform goes on beside it.
TEST_F(CompressedBlocks, AreDecodedBeforeTheyAreTested) {
  program_.write("rays.csv", "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n0,camera,-900,0,-900,1,0,1,0,inf\n");
  const std::string machine =
      "scene: {builtin: terrain, triangles: 18, quantise: 10}\nworkload: {rays_from: rays.csv}\n"
      "bvh: {width: 2, leaf_triangles: 16, leaves: blocks}\ntopology: {resources: 1}\npackets: {rays: 1}\n"
      "collections: {ready: 1}\n";
  for (const char* shape : {"ring", "independent"}) {
    const std::string on = fmt::format("topology.shape={}", shape);
    const auto cycles = [&](const char* decoder) -> std::int64_t {
      return report(machine, {on, fmt::format("testers.decoder={{units: 1, {}}}", decoder)})["engine"]["cycles"];
    };
    const Json run = report(machine, {on});
    const auto visits = static_cast<std::int64_t>(decoded(run));  // of one block each, one after another
    EXPECT_GT(visits, 0);
    EXPECT_EQ(cycles("latency_cycles: 108") - cycles("latency_cycles: 8"), 100 * visits) << shape;
  }
}

// A packet with data brings whole blocks, and memory reads them.
TEST_F(CompressedBlocks, TakeTheirBytesOnLinksAndInMemory) {
  const std::string machine =
      "scene: {builtin: terrain, triangles: 2000, quantise: 12}\nbvh: {leaf_triangles: 16}\n" + kSmall;
  const std::vector<std::string> data{"packets.carry=data", "memory.fetch=packet"};
  const auto with = [&](std::vector<std::string> sets) {
    sets.insert(sets.end(), data.begin(), data.end());
    return report(machine, sets);
  };
  const Json triangles = with({"bvh.storage=quantised"}), blocks = with({"bvh.storage=quantised", "bvh.leaves=blocks"});
  const Json& counts = blocks["memory"]["triangle_blocks"];
  EXPECT_EQ(counts["bytes"].get<std::uint64_t>(), 128 * counts["blocks"].get<std::uint64_t>());
  EXPECT_LE(counts["bytes_per_triangle"].get<double>(), 12);
  EXPECT_LE(counts["structure_bytes_per_triangle"].get<double>(), 20);
  EXPECT_LT(3 * blocks["structure"]["bytes"].get<double>(), triangles["structure"]["bytes"].get<double>());
  EXPECT_FALSE(triangles["memory"].contains("triangle_blocks"));
  EXPECT_LT(bytes(blocks, "packets"), bytes(triangles, "packets"));
}

TEST_F(CompressedBlocks, AreChargedInJoulesAndArea) {
  const std::string machine =
      "scene: {builtin: terrain, triangles: 2000, quantise: 12}\nbvh: {leaves: blocks}\nenergy: {profile: n45}\n" +
      kSmall;
  const Json blocks = report(machine), dearer = report(machine, {"energy.decoder=114.4", "area.decoder=1.0126"}),
             none = report(machine, {"bvh.leaves=triangles"});
  const auto decoding = [](const Json& run, const char* key) -> double {
    return run["energy"]["parts"]["decoded_blocks"][key];
  };
  const auto units = [](const Json& run) -> double { return run["area"]["parts"]["test_units"]["mm2"]; };
  EXPECT_EQ(decoding(blocks, "events"), static_cast<double>(decoded(blocks)));
  EXPECT_NEAR(decoding(blocks, "joules"), 14.4e-12 * static_cast<double>(decoded(blocks)), 1e-14);
  EXPECT_NEAR(decoding(dearer, "joules"), 114.4e-12 * static_cast<double>(decoded(blocks)), 1e-14);
  EXPECT_EQ(decoding(none, "events"), 0);
  EXPECT_NEAR(units(blocks) - units(none), 4 * 0.0126, 1e-6);  // one in each of four resources
  EXPECT_NEAR(units(dearer) - units(none), 4 * 1.0126, 1e-5);
  EXPECT_FALSE(none["tests"].contains("decoded"));
}

}  // namespace
}  // namespace carousel::compressed_blocks_test
