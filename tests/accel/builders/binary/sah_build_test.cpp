#include "accel/builders/binary/sah_build.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "tests/accel/traverse/test_rays.h"

namespace carousel::accel {
namespace {

BuildPrimitives primitives_of(const std::vector<Aabb>& boxes) {
  BuildPrimitives out(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    out[i].lo = boxes[i].lo;
    out[i].hi = boxes[i].hi;
    out[i].index = static_cast<std::uint32_t>(i);
  }
  return out;
}

std::vector<Aabb> random_boxes(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Aabb> boxes(count);
  for (Aabb& b : boxes) {
    const Vec3 p = random.in_box(Vec3{-10}, Vec3{10});
    b.extend(p);
    b.extend(p + random.in_box(Vec3{0}, Vec3{0.3f}));
  }
  return boxes;
}

bool contains(const Aabb& outer, const Aabb& inner) {
  for (int a = 0; a < 3; ++a)
    if (inner.lo[a] < outer.lo[a] || inner.hi[a] > outer.hi[a]) return false;
  return true;
}

struct Checked {
  int depth = 0;
  std::size_t nodes = 0;
};

/// Walks the tree: every primitive in exactly one leaf, leaves within the limit, boxes around their contents.
Checked check(const BinaryTree& nodes, const BuildPrimitives& primitives, std::uint32_t leaf) {
  Checked out;
  std::vector<int> seen(primitives.size(), 0);
  struct Item {
    std::uint32_t node;
    int depth;
  };
  std::vector<Item> stack{{0, 1}};
  while (!stack.empty()) {
    const Item item = stack.back();
    stack.pop_back();
    const BinaryNode& n = nodes.at(item.node);
    ++out.nodes;
    out.depth = std::max(out.depth, item.depth);
    if (n.count > 0) {
      EXPECT_LE(n.count, leaf);
      for (std::uint32_t i = n.first; i < n.first + n.count; ++i) {
        ++seen.at(i);
        EXPECT_TRUE(contains(n.box, {primitives[i].lo, primitives[i].hi}));
      }
      continue;
    }
    for (const std::uint32_t child : {n.first, n.right}) {
      EXPECT_GT(child, item.node);
      EXPECT_TRUE(contains(n.box, nodes.at(child).box));
      stack.push_back({child, item.depth + 1});
    }
  }
  EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int s) { return s == 1; }));
  std::vector<std::uint32_t> indices;
  for (const BuildPrimitive& p : primitives) indices.push_back(p.index);
  std::sort(indices.begin(), indices.end());
  for (std::uint32_t i = 0; i < indices.size(); ++i) EXPECT_EQ(indices[i], i);
  return out;
}

Checked build_and_check(const std::vector<Aabb>& boxes, std::uint32_t leaf) {
  BuildPrimitives primitives = primitives_of(boxes);
  const SahSettings settings{.leaf_primitives = leaf, .block_primitives = std::min(4u, leaf)};
  const auto nodes = build_sah(primitives, settings, *make_sequential_executor());
  return check(nodes, primitives, leaf);
}

TEST(SahBuild, HoldsEveryPrimitiveOnce) {
  for (const std::size_t count : {1u, 2u, 3u, 5u, 17u, 1000u, 20000u})
    for (const std::uint32_t leaf : {1u, 4u, 8u, 16u}) build_and_check(random_boxes(count, count), leaf);
}

// Others reported this kind of fault: svenstaro/bvh 44, Ignis 3.
TEST(SahBuild, KeepsDepthWhenAllCentroidsCoincide) {
  std::vector<Aabb> boxes(5000);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const float size = static_cast<float>(i % 7);
    boxes[i] = {Vec3{-size}, Vec3{size}};
  }
  EXPECT_LE(build_and_check(boxes, 1).depth, 15);  // halves: log2 of 5000 and one
}

TEST(SahBuild, KeepsDepthOnExponentiallySpacedPoints) {
  for (const int axes : {1, 3}) {
    std::vector<Aabb> boxes;
    for (int i = -120; i < 120; ++i) {
      Vec3 p{0};
      for (int a = 0; a < axes; ++a) p[a] = std::ldexp(1.0f, i);
      boxes.push_back({p, p});
      boxes.push_back({-p, -p});
    }
    EXPECT_LE(build_and_check(boxes, 1).depth, 73);
  }
}

TEST(SahBuild, SurvivesBoxesWhoseSumsOverflow) {
  std::vector<Aabb> boxes;
  for (int i = 0; i < 200; ++i) {
    const float x = 3e38f * (static_cast<float>(i) / 100 - 1);
    boxes.push_back({Vec3{x}, Vec3{x + 1e37f}});
  }
  build_and_check(boxes, 4);
}

TEST(SahBuild, SeparatesTwoClusters) {
  std::vector<Aabb> boxes = random_boxes(64, 5);
  for (std::size_t i = 0; i < 64; i += 2) boxes[i].lo.x += 1000, boxes[i].hi.x += 1000;
  BuildPrimitives primitives = primitives_of(boxes);
  const auto nodes = build_sah(primitives, {}, *make_sequential_executor());
  EXPECT_LT(nodes[nodes[0].first].box.hi.x, nodes[nodes[0].right].box.lo.x);
}

TEST(SahBuild, IsTheSameForEveryExecutor) {
  const std::vector<Aabb> boxes = random_boxes(200000, 6);  // large enough for parallel nodes and binning
  std::vector<std::unique_ptr<Executor>> executors;
  executors.push_back(make_sequential_executor());
  executors.push_back(make_jthread_executor(2));
  executors.push_back(make_jthread_executor(4));
#ifndef __SANITIZE_THREAD__  // Debian's TBB is not instrumented and would be reported
  executors.push_back(make_tbb_executor(2));
  executors.push_back(make_tbb_executor(4));
#endif
  BinaryTree first;
  BuildPrimitives first_order;
  for (const auto& executor : executors) {
    BuildPrimitives primitives = primitives_of(boxes);
    const auto nodes = build_sah(primitives, {}, *executor);
    if (first.empty()) {
      check(nodes, primitives, 4);
      first = nodes;
      first_order = primitives;
      continue;
    }
    ASSERT_EQ(nodes.size(), first.size());
    std::vector<std::uint32_t> open{0};  // not every place holds a node
    while (!open.empty()) {
      const std::uint32_t i = open.back();
      open.pop_back();
      if (nodes[i].count == 0) open.insert(open.end(), {nodes[i].first, nodes[i].right});
      ASSERT_EQ(nodes[i].box.lo, first[i].box.lo) << i;
      ASSERT_EQ(nodes[i].box.hi, first[i].box.hi) << i;
      ASSERT_EQ(nodes[i].first, first[i].first) << i;
      ASSERT_EQ(nodes[i].right, first[i].right) << i;
      ASSERT_EQ(nodes[i].count, first[i].count) << i;
    }
    for (std::size_t i = 0; i < primitives.size(); ++i) ASSERT_EQ(primitives[i].index, first_order[i].index) << i;
  }
}

}  // namespace
}  // namespace carousel::accel
