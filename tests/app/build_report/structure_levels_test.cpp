// The levels of a structure in the report, against what the structure itself holds.
#include "app/build_report/structure_levels.h"

#include <map>

#include <gtest/gtest.h>

#include "tests/accel/structure/test_scenes.h"

namespace carousel::structure_levels_test {
namespace {

using report::StructureLevel;

std::map<std::string, StructureLevel> levels_of(const accel::Accel& accel, const BvhConfig& bvh,
                                                std::uint64_t* size = nullptr) {
  const ringbus::cycle::ShapeMemory memory(accel, {}, bvh);
  if (size != nullptr) *size = memory.size_bytes();
  std::map<std::string, StructureLevel> out;
  for (const StructureLevel& level : app::structure_levels(accel, memory)) out[level.level] = level;
  return out;
}

TEST(StructureLevels, HoldTheTopLevelOfManyInstances) {
  // Meshes of four triangles are one leaf each, so that all nodes are above the instances.
  scene::Scene scene = accel::scene_of(accel::soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  for (int i = 1; i < 5000; ++i) accel::add_instance(scene, 0, {Mat3(1.0f), {2.0f * static_cast<float>(i), 0, 0}});
  const BvhConfig bvh;
  const accel::Accel accel = accel::build(scene, bvh, *make_sequential_executor());
  std::uint64_t size = 0;
  auto levels = levels_of(accel, bvh, &size);
  ASSERT_EQ(levels.size(), 2u);
  const StructureLevel &top = levels["top"], &meshes = levels["meshes"];
  EXPECT_EQ(top.structures, 1u);
  EXPECT_EQ(top.inner_nodes, accel.nodes.size());
  EXPECT_EQ(top.leaves, 0u);
  EXPECT_EQ(top.node_bytes, accel.nodes.size() * 256);
  EXPECT_EQ(top.children, accel.nodes.size() - 1 + 5000);  // each node but the root, and each instance, is one
  EXPECT_EQ(meshes.instances, 5000u);
  EXPECT_EQ(meshes.structures, 1u);
  EXPECT_EQ(meshes.leaves, 1u);
  EXPECT_EQ(meshes.depth, 1u);
  EXPECT_EQ(meshes.leaf_bytes, 160u);
  EXPECT_EQ(meshes.record_bytes, (5000 - 1) * 48u);  // the first has no transform
  EXPECT_EQ(top.depth + meshes.depth, static_cast<std::uint64_t>(accel.max_depth));
  EXPECT_GE(size, top.bytes() + meshes.bytes());
}

TEST(StructureLevels, AddUpToAllNodesAndLeaves) {
  for (const std::int64_t of_scene : {2, 5})
    for (const BvhConfig::Storage storage : {BvhConfig::Storage::kFull, BvhConfig::Storage::kQuantised})
      for (const BvhConfig::Merge merge : {BvhConfig::Merge::kNone, BvhConfig::Merge::kWorld}) {
        scene::Scene scene = accel::small_builtin(BuiltinScene::kInstances, 0, 200, of_scene);
        for (int i = 0; i < 2; ++i)  // these stand in the world, not in a group
          accel::add_instance(scene, accel::add_mesh(scene, accel::icosphere_scene(2).meshes[0]));
        BvhConfig bvh;
        bvh.levels = of_scene;
        bvh.storage = storage;
        bvh.merge = merge;
        const accel::Accel accel = accel::build(scene, bvh, *make_sequential_executor());
        std::uint64_t size = 0, nodes = 0, primitives_bytes = 0, sum = 0;
        const auto levels = levels_of(accel, bvh, &size);
        EXPECT_EQ(levels.count("groups"), accel.groups.empty() ? 0u : 1u);
        for (const auto& [name, level] : levels) {
          nodes += level.inner_nodes;
          primitives_bytes += level.leaf_bytes;
          sum += level.bytes();
          EXPECT_LE(level.children, 8 * level.inner_nodes);
        }
        // The topmost nodes of merged meshes give way to their children, which hang in the top level.
        if (merge == BvhConfig::Merge::kNone) {
          EXPECT_EQ(nodes, accel.nodes.size());
        } else {
          EXPECT_LE(nodes, accel.nodes.size());
        }
        EXPECT_GT(primitives_bytes, 0u);
        EXPECT_LE(sum, size);
        EXPECT_GT(sum, size / 2);
      }
}

TEST(StructureLevels, HaveNoNodesAboveAnOnlyMesh) {
  const scene::Scene scene = accel::icosphere_scene(3);
  const accel::Accel accel = accel::build(scene, {}, *make_sequential_executor());
  auto levels = levels_of(accel, {});
  EXPECT_EQ(levels["top"].inner_nodes, 0u);
  EXPECT_EQ(levels["meshes"].instances, 1u);
  EXPECT_EQ(levels["meshes"].inner_nodes + 1, accel.nodes.size());  // the top level's root is not used
}

}  // namespace
}  // namespace carousel::structure_levels_test
