// The structure by level and depth in the report, against other counts of the same run.
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::structure_depths_test {
namespace {

class StructureDepths : public TimedRun {
 protected:
  static double sum(const Json& rows, const std::string& level, const char* key) {
    double out = 0;
    for (const Json& row : rows)
      if (level.empty() || row["level"] == level) out += row[key].get<double>();
    return out;
  }
  static std::uint64_t reads(const Json& rows, const std::string& level, const char* key) {
    std::uint64_t out = 0;
    for (const Json& row : rows)
      if (level.empty() || row["level"] == level) out += row["reads"][key].get<std::uint64_t>();
    return out;
  }
};

const std::string kSmall = "image: {width: 16, height: 12, samples: 1, max_depth: 2}\ntopology: {resources: 4}\n";

TEST_F(StructureDepths, AddUpToTheLevels) {
  const std::vector<std::pair<const char*, const char*>> structures{
      {"builtin: terrain, triangles: 2000, quantise: 12", "{leaves: blocks}"},
      {"builtin: spheres, triangles: 3000", "{leaf_triangles: 1, width: 3}"},
      {"builtin: instances, triangles: 300, instances: 200, levels: 4", "{levels: 4, storage: quantised}"}};
  for (const auto& [scene, bvh] : structures) {
    const Json run = report(fmt::format("scene: {{{}}}\nbvh: {}\n", scene, bvh) + kSmall);
    const Json &structure = run["structure"], &depths = structure["depths"];
    for (const Json& level : structure["levels"]) {
      const std::string name = level["level"];
      EXPECT_EQ(sum(depths, name, "inner_nodes"), level["inner_nodes"].get<double>());
      EXPECT_EQ(sum(depths, name, "leaves"), level["leaves"].get<double>());
      EXPECT_EQ(sum(depths, name, "bytes"), level["node_bytes"].get<double>() + level["leaf_bytes"].get<double>());
      EXPECT_NEAR(sum(depths, name, "surface_cost"), level["surface_cost"].get<double>(), 1e-9);
    }
    EXPECT_NEAR(sum(depths, "meshes", "surface_cost"), structure["surface_cost"].get<double>(),
                1e-6 * structure["surface_cost"].get<double>())
        << scene << bvh;
  }
}

// A terrain has no transforms, so that all that shape buffers hold is nodes and leaves.
TEST_F(StructureDepths, CountAllReadsOfAMachine) {
  const std::string machine =
      "scene: {builtin: terrain, triangles: 4000}\nmemory: {shape_buffer_kib: 4, l2_kib: 16}\n" + kSmall;
  for (const std::vector<std::string>& sets :
       std::vector<std::vector<std::string>>{{},
                                             {"topology.shape=independent"},
                                             {"topology.shape=independent", "testers.simt.warp=8"},
                                             {"packets.carry=data", "memory.fetch=packet"},
                                             {"collections.traversal=treelet"}}) {
    const Json run = report(machine, sets);
    const Json &depths = run["structure"]["depths"], &buffers = run["memory"]["shape_buffers"];
    const auto of = [&](const char* key) { return buffers[key].get<std::uint64_t>(); };
    EXPECT_GT(reads(depths, "meshes", "misses"), 0u);
    EXPECT_EQ(reads(depths, "", "misses"), of("misses"));
    EXPECT_EQ(reads(depths, "", "needed"), of("hits") + of("merged") + of("misses"));
  }
}

// The root is needed by all rays, and is there after its first fetch by each resource.
TEST_F(StructureDepths, FindTheRootInEveryShapeBuffer) {
  const Json run = report("scene: {builtin: terrain, triangles: 4000}\nmemory: {shape_buffer_kib: 256}\n" + kSmall,
                          {"topology.shape=independent"});
  const Json& root = run["structure"]["depths"][0];
  EXPECT_EQ(root["inner_nodes"], 1u);
  EXPECT_EQ(root["surface_cost"], 1.0);
  EXPECT_EQ(root["reads"]["needed"], run["rays"]["completed"]);
  EXPECT_EQ(root["reads"]["misses"], 4u);
}

TEST_F(StructureDepths, HaveTheTopLevelOfInstances) {
  const Json run = report("scene: {builtin: instances, triangles: 300, instances: 200}\n" + kSmall);
  const Json& depths = run["structure"]["depths"];
  EXPECT_EQ(depths[0]["level"], "top");
  EXPECT_GT(reads(depths, "top", "needed"), 0u);
  EXPECT_GT(reads(depths, "meshes", "needed"), 0u);
  const Json native = report("scene: {builtin: cornell}\n" + kSmall, {"engine.kind=native"});
  EXPECT_FALSE(native["structure"]["depths"][0].contains("reads"));
}

}  // namespace
}  // namespace carousel::structure_depths_test
