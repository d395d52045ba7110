// Collections of rays that wait in a block of memory (US 9633468, columns 14 and 34): each ray is tested with its own
// node, so all that rays do stays the same, and a visit reads the whole block.
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::block_collections_test {
namespace {

class BlockCollections : public TimedRun {
 protected:
  Json with(const std::string& machine, const std::string& key, const std::vector<std::string>& more = {}) {
    std::vector<std::string> sets{"collections.traversal=ordered", "collections.key=" + key};
    sets.insert(sets.end(), more.begin(), more.end());
    return report(machine, sets);
  }
  static std::uint64_t bytes_of_shapes(const Json& report) { return bytes(report, "shape data"); }
};

constexpr const char* kScenes[] = {"{builtin: terrain, triangles: 3000}", "{builtin: cornell}",
                                   "{builtin: instances, instances: 20, triangles: 500}"};

std::string machine_of(const char* scene, int width) {
  return fmt::format(
      "scene: {}\nimage: {{width: {}, height: 16, samples: 1, max_depth: 3}}\ntopology: {{resources: 4}}\n", scene,
      width);
}

// No two nodes begin in the same 64 bytes.
TEST_F(BlockCollections, OfASingleNodeAreThoseOfNodesToTheCycle) {
  for (const char* scene : kScenes) {
    const std::string machine = machine_of(scene, 16);
    Json node = with(machine, "node"), block = with(machine, "block", {"collections.block_bytes=64"});
    for (const char* section : {"engine", "rays", "tests", "nodes", "packets", "collections", "resources", "links",
                                "bytes", "memory", "digest"})
      EXPECT_EQ(block[section], node[section]) << scene << " " << section;
  }
}

TEST_F(BlockCollections, LeaveEachRayItsWay) {
  for (const char* scene : kScenes)
    for (const int width : {16, 40}) {
      const std::string machine = machine_of(scene, width);
      const Json node = with(machine, "node");
      for (const int bytes : {1024, 16384}) {
        const Json block = with(machine, "block", {fmt::format("collections.block_bytes={}", bytes)});
        EXPECT_EQ(block["digest"], node["digest"]) << scene;
        EXPECT_EQ(block["tests"]["box"], node["tests"]["box"]) << scene;
        const Json &by_block = block["nodes"]["by_depth"], &by_node = node["nodes"]["by_depth"];
        ASSERT_EQ(by_block.size(), by_node.size()) << scene;
        for (std::size_t depth = 0; depth < by_node.size(); ++depth)
          for (const char* count : {"depth", "rays", "box_tests", "triangle_tests", "children_hit", "misses"})
            EXPECT_EQ(by_block[depth][count], by_node[depth][count]) << scene << " depth " << depth << " " << count;
        EXPECT_LT(block["packets"]["issued"], node["packets"]["issued"]) << scene << " " << bytes;
        EXPECT_GT(bytes_of_shapes(block), bytes_of_shapes(node)) << scene << " " << bytes;
      }
    }
}

// Eight rays that hit the first of three leaves below the root. Shapes are read in places of 64 bytes.
TEST_F(BlockCollections, AVisitReadsTheWholeBlock) {
  std::string rays = "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n";
  for (int i = 0; i < 8; ++i) rays += fmt::format("{},camera,-900,0,-900,1,0,1,0,inf\n", i);
  program_.write("rays.csv", rays);
  const auto run = [this](const char* key) {
    return with(
        "scene: {builtin: terrain, triangles: 18}\nworkload: {rays_from: rays.csv}\ntopology: {resources: 1}\n"
        "bvh: {width: 4, leaf_triangles: 16}\npackets: {rays: 8}\n",
        key, {"collections.block_bytes=65536"});
  };
  const Json node = run("node"), block = run("block");
  EXPECT_EQ(block["digest"], node["digest"]);
  EXPECT_EQ(block["packets"]["issued"], node["packets"]["issued"]);
  EXPECT_EQ(bytes_of_shapes(node), 256 + 5 * 64);  // the root and a leaf of two blocks of 160 bytes
  // The root of the mesh and that of the top level, and the five blocks of all leaves, 800 bytes.
  EXPECT_EQ(bytes_of_shapes(block), 2 * 256 + 13 * 64);
}

}  // namespace
}  // namespace carousel::block_collections_test
