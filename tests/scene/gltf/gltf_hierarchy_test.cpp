// The groups that the importer finds in a tree of nodes.
#include <gtest/gtest.h>

#include "tests/scene/gltf/gltf_builder.h"

namespace carousel::scene {
namespace {

using Json = nlohmann::json;

/// A builder whose scene shows nothing yet, with two meshes of a square.
GltfBuilder two_squares() {
  GltfBuilder b = GltfBuilder::square();
  b.mesh({{"POSITION", 0}}, 1);
  b.json["nodes"] = Json::array();
  b.json["scenes"][0]["nodes"] = Json::array();
  return b;
}

/// A node of a mesh; not a root.
int shape(GltfBuilder& b, int mesh, double x) {
  return b.push("nodes", {{"mesh", mesh}, {"translation", {x, 0, 0}}});
}

TEST(GltfHierarchy, FindsEqualNodesToBeOneGroup) {
  GltfBuilder b = two_squares();
  std::vector<int> pairs;
  for (int k = 0; k < 3; ++k) {
    const int first = shape(b, 0, 1), second = shape(b, 1, 2);
    pairs.push_back(b.push("nodes", {{"children", {first, second}}, {"translation", {0, 10 * k, 0}}}));
  }
  b.node({{"children", pairs}});
  const int first = shape(b, 0, 1), other = shape(b, 1, 2.5);
  b.node({{"children", {first, other}}, {"translation", {0, 0, 7}}});
  const Scene scene = b.load();
  ASSERT_EQ(scene.instances.size(), 8u);
  ASSERT_EQ(scene.groups.size(), 3u);  // pairs, the three pairs, and the other pair
  ASSERT_EQ(scene.placements.size(), 5u);
  const auto group = [&](std::size_t placement) { return scene.placements[placement].group; };
  EXPECT_EQ(group(1), group(2));
  EXPECT_EQ(group(1), group(3));
  EXPECT_NE(group(1), group(4));
  EXPECT_EQ(scene.placements[0].parent, kNoPlacement);
  EXPECT_EQ(scene.placements[4].parent, kNoPlacement);
  for (std::uint32_t k = 0; k < 3; ++k) {
    EXPECT_EQ(scene.placements[k + 1].parent, 0u);
    EXPECT_EQ(scene.placements[k + 1].member, k);
    EXPECT_EQ(scene.placements[k + 1].world_from_group.translation, Vec3(0, 10 * k, 0));
  }
  for (std::uint32_t i = 0; i < 8; ++i) {
    EXPECT_EQ(scene.instances[i].placement, 1 + i / 2);
    EXPECT_EQ(scene.instances[i].member, i % 2);
    EXPECT_EQ(scene.groups[group(1 + i / 2)].members[i % 2], (Group::Member{false, scene.instances[i].mesh.value}));
  }
}

TEST(GltfHierarchy, TakesChainsOfOneMemberForTheMember) {
  GltfBuilder b = two_squares();
  // Two ways to stand at 1 and 3; lights and empty nodes are no members.
  const int empty = b.push("nodes", {{"name", "empty"}});
  const int a = shape(b, 0, 1), deep = shape(b, 0, 1),
            chain = b.push("nodes", {{"children", {deep}}, {"translation", {2, 0, 0}}});
  b.node({{"children", {a, empty, chain}}});
  const int c = shape(b, 0, 1), d = shape(b, 0, 3);
  const int below = b.push("nodes", {{"children", {c, d}}});
  b.node({{"children", {below}}, {"translation", {0, 5, 0}}});
  const Scene scene = b.load();
  ASSERT_EQ(scene.groups.size(), 1u);
  ASSERT_EQ(scene.placements.size(), 2u);
  EXPECT_EQ(scene.placements[1].world_from_group.translation, Vec3(0, 5, 0));
  ASSERT_EQ(scene.instances.size(), 4u);
  for (std::uint32_t i = 0; i < 4; ++i) {
    EXPECT_EQ(scene.instances[i].placement, i / 2);
    EXPECT_EQ(scene.instances[i].member, i % 2);
  }
}

TEST(GltfHierarchy, HoldsMeshesOfTheNodeItselfAndGpuInstancing) {
  GltfBuilder b = two_squares();
  const int t = b.floats({1, 0, 0, 2, 0, 0}, "VEC3", 3);
  const Json instanced = {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", t}}}}}};
  for (int k = 0; k < 2; ++k) {
    const int child = shape(b, 1, 4);
    b.node({{"mesh", 0}, {"extensions", instanced}, {"children", {child}}, {"translation", {0, k, 0}}});
  }
  const Scene scene = b.load();
  ASSERT_EQ(scene.groups.size(), 1u);
  EXPECT_EQ(scene.groups[0].members, (std::vector<Group::Member>{{false, 0}, {false, 0}, {false, 1}}));
  ASSERT_EQ(scene.placements.size(), 2u);
  for (std::uint32_t i = 0; i < 6; ++i) EXPECT_EQ(scene.instances[i].member, i % 3);
}

// Others reported this kind of fault: glTF 1699, tinybvh 92.
TEST(GltfHierarchy, IsReadFromNodesOfAnyDepth) {
  GltfBuilder b = two_squares();
  constexpr int kDepth = 20000;
  int below = shape(b, 0, 0);
  for (int k = 0; k < kDepth; ++k) {
    const int beside = shape(b, 1, 1);
    below = b.push("nodes", {{"children", {below, beside}}});
  }
  b.json["scenes"][0]["nodes"] = Json::array({below});
  const Scene scene = b.load();
  EXPECT_EQ(scene.placements.size(), static_cast<std::size_t>(kDepth));
  EXPECT_EQ(scene.groups.size(), static_cast<std::size_t>(kDepth));
}

}  // namespace
}  // namespace carousel::scene
