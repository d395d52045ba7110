// Subtrees that are moved to better places (`bvh.quality: high`).
#include "accel/builders/binary/reinsertion.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel::reinsertion_test {
namespace {

std::vector<Aabb> boxes_around(const std::vector<Vec3>& centers, std::uint64_t seed) {
  Random random(seed);
  std::vector<Aabb> out;
  for (const Vec3& center : centers) {
    const Vec3 half = random.in_box(Vec3{0}, Vec3{0.3f});
    out.push_back({center - half, center + half});
  }
  return out;
}

std::vector<Aabb> random_boxes(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3> centers(count);
  for (Vec3& center : centers) center = random.in_box(Vec3{-1}, Vec3{1});
  return boxes_around(centers, seed + 1);
}

/// A tree over the boxes in the order in which they stand, by halves; each is a leaf.
BinaryTree by_halves(const std::vector<Aabb>& boxes) {
  BinaryTree out;
  const std::function<std::uint32_t(std::uint32_t, std::uint32_t)> build = [&](std::uint32_t begin, std::uint32_t end) {
    const auto at = static_cast<std::uint32_t>(out.size());
    out.emplace_back(BinaryNode{});
    if (end - begin == 1) {
      out[at] = {boxes[begin], begin, 0, 1};
      return at;
    }
    const std::uint32_t left = build(begin, (begin + end) / 2), right = build((begin + end) / 2, end);
    out[at] = {out[left].box, left, right, 0};
    out[at].box.extend(out[right].box);
    return at;
  };
  build(0, static_cast<std::uint32_t>(boxes.size()));
  return out;
}

/// The measures of a tree, found by a walk from its root with boxes of its own.
struct Walked {
  double area = 0;                                // area of inner nodes
  int depth = 0;                                  // levels below the root
  std::map<std::uint32_t, std::uint32_t> leaves;  // counts by first primitive
};
Walked walk(const BinaryTree& nodes) {
  Walked out;
  const std::function<Aabb(std::uint32_t, int)> visit = [&](std::uint32_t at, int depth) {
    const BinaryNode& node = nodes.at(at);
    out.depth = std::max(out.depth, depth);
    if (node.count > 0) {
      EXPECT_TRUE(out.leaves.emplace(node.first, node.count).second);
      return node.box;
    }
    Aabb box = visit(node.first, depth + 1);
    box.extend(visit(node.right, depth + 1));
    EXPECT_EQ(box.lo, node.box.lo);
    EXPECT_EQ(box.hi, node.box.hi);
    out.area += static_cast<double>(box.half_area());
    return box;
  };
  visit(0, 0);
  return out;
}

void refit(BinaryTree& nodes, std::uint32_t at = 0) {
  if (nodes[at].count > 0) return;
  refit(nodes, nodes[at].first);
  refit(nodes, nodes[at].right);
  nodes[at].box = nodes[nodes[at].first].box;
  nodes[at].box.extend(nodes[nodes[at].right].box);
}

std::uint32_t& link_to(BinaryTree& nodes, std::uint32_t at) {
  for (BinaryNode& node : nodes)
    if (node.count == 0) {
      if (node.first == at) return node.first;
      if (node.right == at) return node.right;
    }
  throw std::logic_error("no parent");
}
std::uint32_t parent_of(const BinaryTree& nodes, std::uint32_t at) {
  for (std::uint32_t i = 0; i < nodes.size(); ++i)
    if (nodes[i].count == 0 && (nodes[i].first == at || nodes[i].right == at)) return i;
  return 0;
}
bool below(const BinaryTree& nodes, std::uint32_t at, std::uint32_t top) {
  while (at != 0 && at != top) at = parent_of(nodes, at);
  return at == top;
}

/// The least area after a single move of any subtree to any other place, by trying all of them.
double best_after_a_move(const BinaryTree& nodes) {
  double best = walk(nodes).area;
  for (std::uint32_t from = 1; from < nodes.size(); ++from) {
    const std::uint32_t parent = parent_of(nodes, from);
    if (parent == 0) continue;
    const std::uint32_t other = nodes[parent].first == from ? nodes[parent].right : nodes[parent].first;
    for (std::uint32_t to = 1; to < nodes.size(); ++to) {
      if (to == parent || to == other || below(nodes, to, from)) continue;
      BinaryTree moved = nodes;
      link_to(moved, parent) = other;
      link_to(moved, to) = parent;
      moved[parent].first = to;
      moved[parent].right = from;
      refit(moved);
      best = std::min(best, walk(moved).area);
    }
  }
  return best;
}

// It stops where a round gains little; begun again until nothing is moved, it leaves nothing to gain.
TEST(Reinsertion, LeavesNoMoveThatGains) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    BinaryTree nodes = by_halves(random_boxes(3 + seed % 12, run_seed() + seed));
    const Walked before = walk(nodes);
    Walked after = before;
    double area;
    do {
      area = after.area;
      reinsert(nodes, *make_sequential_executor());
      after = walk(nodes);
      ASSERT_LE(after.area, area);
      ASSERT_EQ(after.leaves, before.leaves);
    } while (after.area < area);
    EXPECT_GE(best_after_a_move(nodes), (1 - 1e-6) * after.area) << seed;
  }
}

// Boxes of two distant clusters by turns: nearly every one is in a wrong place.
TEST(Reinsertion, ComesNearTheSurfaceAreaHeuristicFromABadTree) {
  Random random(run_seed());
  std::vector<Vec3> centers;
  for (int i = 0; i < 2000; ++i)
    centers.push_back(random.in_box(Vec3{-1}, Vec3{1}) + Vec3{i % 2 == 0 ? 20.0f : 0.0f, 0, 0});
  const std::vector<Aabb> boxes = boxes_around(centers, run_seed());
  BuildPrimitives primitives(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i)
    primitives[i].lo = boxes[i].lo, primitives[i].hi = boxes[i].hi, primitives[i].index = static_cast<std::uint32_t>(i);
  const auto executor = make_sequential_executor();
  const double good = walk(build_sah(primitives, {.leaf_primitives = 1, .block_primitives = 1}, *executor)).area;
  BinaryTree nodes = by_halves(boxes);
  ASSERT_GT(walk(nodes).area, 5 * good);
  for (int i = 0; i < 8; ++i) reinsert(nodes, *executor);
  EXPECT_LT(walk(nodes).area, 1.5 * good);
}

/// Boxes one within the other, of sizes so near that floats tell the least from the sum of all, in a chain of `length`
/// inner nodes; two smaller ones hang together near its root, and are best off at its end, two levels further down than
/// the last box.
BinaryTree chain_and_a_pair(int length) {
  BinaryTree out;
  const auto leaf = [&](float size) {
    out.push_back({{Vec3{-size}, Vec3{size}}, static_cast<std::uint32_t>(out.size()), 0, 1});
    return static_cast<std::uint32_t>(out.size() - 1);
  };
  const std::function<std::uint32_t(int)> chain = [&](int at) {
    const float size = std::exp2(-0.125f * static_cast<float>(at));
    if (at == length) return leaf(size);
    const auto node = static_cast<std::uint32_t>(out.size());
    out.emplace_back(BinaryNode{});
    std::uint32_t beside;
    if (at == 1) {
      beside = static_cast<std::uint32_t>(out.size());
      out.emplace_back(BinaryNode{});
      const float tiny = std::exp2(-10.0f);
      const std::uint32_t left = leaf(tiny), right = leaf(tiny);
      out[beside].first = left, out[beside].right = right;
    } else {
      beside = leaf(size);
    }
    const std::uint32_t rest = chain(at + 1);
    out[node].first = beside, out[node].right = rest;
    return node;
  };
  chain(0);
  refit(out);
  return out;
}

TEST(Reinsertion, GrowsNoDeeperThanATraversalStack) {
  for (const int length : {60, 71, 72}) {
    BinaryTree nodes = chain_and_a_pair(length);
    const Walked before = walk(nodes);
    ASSERT_EQ(before.depth, length);
    reinsert(nodes, *make_sequential_executor());
    const Walked after = walk(nodes);
    EXPECT_EQ(after.leaves, before.leaves);
    if (length < 72) {
      EXPECT_EQ(after.depth, length + 1);
      EXPECT_LT(after.area, before.area);
    } else {
      EXPECT_EQ(after.depth, 72);
    }
  }
}

TEST(Reinsertion, IsTheSameForEveryExecutor) {
  const BinaryTree nodes = by_halves(random_boxes(5000, run_seed()));
  BinaryTree one = nodes, several = nodes;
  reinsert(one, *make_sequential_executor());
  reinsert(several, *make_jthread_executor(4));
  ASSERT_EQ(one.size(), several.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    ASSERT_EQ(one[i].first, several[i].first);
    ASSERT_EQ(one[i].right, several[i].right);
    ASSERT_EQ(one[i].box.lo, several[i].box.lo);
    ASSERT_EQ(one[i].box.hi, several[i].box.hi);
  }
}

TEST(Reinsertion, TakesTreesOfFewLeavesAndSumsThatOverflow) {
  for (const std::size_t count : {1, 2, 3, 4}) {
    BinaryTree nodes = by_halves(random_boxes(count, run_seed()));
    reinsert(nodes, *make_sequential_executor());
    EXPECT_EQ(walk(nodes).leaves.size(), count);
  }
  std::vector<Aabb> boxes;
  for (int i = 0; i < 50; ++i) {
    const float x = 3e38f * (static_cast<float>(i * 7 % 50) / 25 - 1);
    boxes.push_back({Vec3{x}, Vec3{x + 1e37f}});
  }
  BinaryTree nodes = by_halves(boxes);
  reinsert(nodes, *make_sequential_executor());
  EXPECT_EQ(walk(nodes).leaves.size(), boxes.size());
}

}  // namespace
}  // namespace carousel::accel::reinsertion_test
