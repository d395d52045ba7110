// The promises of the finished two-level structure to the code that traverses it.
#include <cstring>
#include <set>

#include <gtest/gtest.h>

#include "accel/builders/build.h"
#include "accel/structure/accel.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/test_rays.h"

namespace carousel::accel {
namespace {

/// Walks below a key and checks the promises on the way; collects the triangles found.
class Walk {
 public:
  Walk(const Accel& accel, int leaf) : accel_(accel), leaf_(leaf) {}

  std::uint32_t visit(NodeKey key, const Aabb* box, int strip_size, int depth) {
    deepest = std::max(deepest, depth);
    EXPECT_EQ(accel_.strip_size(key), strip_size);
    if (!key.ref.is_inner()) return visit_leaf(key, box);
    const Node& node = accel_.nodes.at(key.ref.node());
    EXPECT_LE(node.count, accel_.width);
    std::uint32_t triangles = 0;
    for (int lane = 0; lane < node.count; ++lane) {
      Aabb child;
      for (int axis = 0; axis < 3; ++axis) {
        child.lo[axis] = node.plane[axis][lane];
        child.hi[axis] = node.plane[axis + 3][lane];
        if (box == nullptr) continue;
        EXPECT_GE(child.lo[axis], box->lo[axis]);
        EXPECT_LE(child.hi[axis], box->hi[axis]);
      }
      const NodeKey below = accel_.child_key(key, lane);
      // Below an instance boxes are the model's.
      const bool enters = key.instance == kNoInstance && below.instance != kNoInstance;
      if (enters) {
        EXPECT_EQ(std::memcmp(&child, &accel_.instances[below.instance].world, sizeof child), 0);
      }
      triangles += visit(below, enters ? nullptr : &child, node.strip_size[lane], depth + 1);
    }
    for (int lane = node.count; lane < kMaxWidth; ++lane) EXPECT_GT(node.plane[0][lane], node.plane[3][lane]);
    EXPECT_EQ(node.triangles, triangles);
    EXPECT_EQ(accel_.triangles_below(key), triangles);
    return triangles;
  }

  std::multiset<std::pair<std::uint32_t, std::uint32_t>> found;  // (instance, primitive)
  int deepest = 0;

 private:
  std::uint32_t visit_leaf(NodeKey key, const Aabb* box) {
    EXPECT_LE(accel_.strip_size(key), leaf_);
    std::uint32_t triangles = 0;
    for (std::uint32_t b = 0; b < key.ref.blocks(); ++b) {
      const TriangleBlock& block = accel_.blocks.at(key.ref.first_block() + b);
      for (int lane = 0; lane < kBlockTriangles; ++lane) {
        if (block.primitive[lane] == kNoPrimitive) continue;
        EXPECT_EQ(triangles, b * kBlockTriangles + static_cast<std::uint32_t>(lane));  // dense
        ++triangles;
        found.insert({key.instance, block.primitive[lane]});
        for (int k = 0; box != nullptr && k < 3; ++k) {
          for (int axis = 0; axis < 3; ++axis) {
            EXPECT_GE(block.vertex[k][axis][lane], box->lo[axis]);
            EXPECT_LE(block.vertex[k][axis][lane], box->hi[axis]);
          }
        }
      }
    }
    return triangles;
  }

  const Accel& accel_;
  int leaf_;
};

TEST(Structure, HoldsEveryTriangleOfEveryInstanceOnce) {
  for (const BuiltinScene builtin : {BuiltinScene::kCornell, BuiltinScene::kTerrain, BuiltinScene::kInstances}) {
    const scene::Scene scene = small_builtin(builtin, 3000, 40);
    for (std::int64_t width = 2; width <= 8; ++width) {
      for (const int leaf : {1, 4, 8, 16}) {
        const Accel accel = build_sequential(scene, width, leaf);
        EXPECT_EQ(accel.width, width);
        Walk walk(accel, leaf);
        const NodeKey root = accel.root_key();
        walk.visit(root, nullptr, accel.strip_size(root), 1);
        EXPECT_EQ(walk.found.size(), scene.instanced_triangle_count());
        EXPECT_EQ(std::set(walk.found.begin(), walk.found.end()).size(), walk.found.size());
        EXPECT_LE(walk.deepest, accel.max_depth);
        EXPECT_EQ(accel.triangles_below(root), scene.instanced_triangle_count());
      }
    }
  }
}

TEST(Structure, MaxDepthBoundsEveryPathOnAdversarialInput) {
  std::vector<Vec3> corners;  // triangles at exponentially falling distances, and many in one place
  for (int i = 0; i < 120; ++i) {
    const float x = std::ldexp(1.0f, -i);
    corners.insert(corners.end(), {Vec3{x, 0, 0}, Vec3{x, x, 0}, Vec3{x, 0, x}});
  }
  for (int i = 0; i < 3000; ++i) corners.insert(corners.end(), {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}});
  const scene::Scene scene = scene_of(soup(corners));
  for (const std::int64_t width : {2, 8}) {
    const Accel accel = build_sequential(scene, width, 1);
    Walk walk(accel, 1);
    walk.visit(accel.root_key(), nullptr, accel.strip_size(accel.root_key()), 1);
    EXPECT_EQ(walk.found.size(), scene.instanced_triangle_count());
    EXPECT_LE(walk.deepest, accel.max_depth);
    EXPECT_LE(accel.max_depth, 76);
    EXPECT_FALSE(trace(accel, mixed_rays(scene, 2000, 51)).empty());  // and no stack overflows
  }
}

/// Visits what is below `ref`, whose nodes and blocks are to have the next numbers.
void expect_depth_first(const Accel& accel, NodeRef ref, std::uint32_t& node, std::uint32_t& block) {
  if (!ref.is_inner()) {
    ASSERT_EQ(ref.first_block(), block);
    block += ref.blocks();
    return;
  }
  ASSERT_EQ(ref.node(), node++);
  const Node& of = accel.nodes[ref.node()];
  for (int lane = 0; lane < of.count; ++lane) expect_depth_first(accel, of.child[lane], node, block);
}

// The meshes have sizes that one thread and that several threads turn into nodes.
TEST(Structure, NumbersNodesAndBlocksDepthFirst) {
  for (const std::int64_t triangles : {3, 2000, 40000}) {
    const Accel accel = build(small_builtin(BuiltinScene::kTerrain, triangles), BvhConfig{}, *make_jthread_executor(3));
    std::uint32_t node = 0, block = 0;
    expect_depth_first(accel, accel.root_key().ref, node, block);
    EXPECT_EQ(block, accel.blocks.size());
  }
}

class StructureOf : public testing::TestWithParam<std::pair<BuiltinScene, std::int64_t>> {};
INSTANTIATE_TEST_SUITE_P(Scenes, StructureOf,
                         testing::Values(std::pair(BuiltinScene::kInstances, std::int64_t{100}),
                                         std::pair(BuiltinScene::kTerrain, std::int64_t{40000})));

TEST_P(StructureOf, IsTheSameForEveryExecutor) {
  const scene::Scene scene = small_builtin(GetParam().first, GetParam().second, 300);
  const Accel expected = build_sequential(scene);
  std::vector<std::unique_ptr<Executor>> executors;
  executors.push_back(make_jthread_executor(3));
#ifndef __SANITIZE_THREAD__  // Debian's TBB is not instrumented and would be reported
  executors.push_back(make_tbb_executor(3));
#endif
  for (const auto& executor : executors) {
    const Accel got = build(scene, BvhConfig{}, *executor);
    ASSERT_EQ(got.nodes.size(), expected.nodes.size());
    ASSERT_EQ(got.blocks.size(), expected.blocks.size());
    for (std::size_t i = 0; i < got.nodes.size(); ++i) {
      ASSERT_EQ(std::memcmp(got.nodes[i].plane, expected.nodes[i].plane, sizeof got.nodes[i].plane), 0);
      ASSERT_EQ(std::memcmp(got.nodes[i].child, expected.nodes[i].child, sizeof got.nodes[i].child), 0);
    }
    for (std::size_t i = 0; i < got.blocks.size(); ++i)
      ASSERT_EQ(std::memcmp(got.blocks[i].primitive, expected.blocks[i].primitive, sizeof got.blocks[i].primitive), 0);
    EXPECT_EQ(got.root_key(), expected.root_key());
    EXPECT_EQ(got.max_depth, expected.max_depth);
  }
}

TEST(Structure, SharesTheTreeOfAMeshAmongInstances) {
  const Accel one = build_sequential(small_builtin(BuiltinScene::kInstances, 100, 100));
  const Accel many = build_sequential(small_builtin(BuiltinScene::kInstances, 100, 1000));
  EXPECT_EQ(one.blocks.size(), many.blocks.size());
}

}  // namespace
}  // namespace carousel::accel
