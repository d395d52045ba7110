// Items dealt out to a tree whose shape stays.
#include "accel/builders/deal.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel::deal_test {
namespace {

std::vector<DealtItem> random_items(std::size_t count, Random& random) {
  std::vector<DealtItem> out;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 middle = random.in_box(Vec3{-1}, Vec3{1}), half = random.in_box(Vec3{0}, Vec3{0.2f});
    out.push_back({{middle - half, middle + half}, i});
  }
  return out;
}

/// A node with places of so many items.
std::vector<DealtNode> flat(const std::vector<std::uint32_t>& places) {
  std::vector<DealtNode> tree(1);
  for (const std::uint32_t place : places) {
    tree[0].children.push_back(static_cast<std::uint32_t>(tree.size()));
    tree.push_back({{}, place});
    tree[0].items += place;
  }
  return tree;
}

double area(const std::vector<DealtItem>& items, const std::vector<std::uint32_t>& which) {
  Aabb box;
  for (const std::uint32_t i : which) box.extend(items[i].box);
  const DVec3 e = DVec3(box.hi) - DVec3(box.lo);
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

/// 1, 2, 2.5, 3, 3.25 and so on.
double levels(std::size_t items) {
  double out = 1;
  for (std::size_t i = 1; i < items; ++i) out += 1 / static_cast<double>(std::bit_floor(i));
  return out;
}

// Two places: all halvings along an axis are tried, so none of them is better than what deal() chooses.
TEST(Deal, TakesTheHalvingOfTheLeastArea) {
  Random random(7);
  for (int round = 0; round < 200; ++round) {
    const std::vector<std::uint32_t> places{1 + static_cast<std::uint32_t>(round % 5), 3};
    const std::vector<DealtNode> tree = flat(places);
    const std::vector<DealtItem> items = random_items(tree[0].items, random);
    std::vector<DealtItem> dealt = items;
    EXPECT_EQ(deal(tree, dealt), 2 * items.size());
    std::vector<std::uint32_t> first, second;
    for (std::size_t i = 0; i < dealt.size(); ++i) (i < places[0] ? first : second).push_back(dealt[i].id);
    const auto cost = [&](const auto& a, const auto& b) {
      return area(items, a) * levels(a.size()) + area(items, b) * levels(b.size());
    };
    const double chosen = cost(first, second);
    std::vector<std::uint32_t> order(items.size());
    double least = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis)
      for (int turn = 0; turn < 2; ++turn) {
        std::iota(order.begin(), order.end(), 0u);
        std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
          const auto middle = [&](std::uint32_t i) { return double{items[i].box.lo[axis]} + items[i].box.hi[axis]; };
          return turn == 0 ? middle(a) < middle(b) : middle(a) > middle(b);
        });
        least = std::min(least, cost(std::vector(order.begin(), order.begin() + places[0]),
                                     std::vector(order.begin() + places[0], order.end())));
      }
    EXPECT_DOUBLE_EQ(chosen, least);
  }
}

TEST(Deal, GivesEachItemOnePlace) {
  Random random(8);
  for (const std::size_t width : {2, 3, 8}) {
    std::vector<DealtNode> tree;
    const std::function<std::uint32_t(int)> grow = [&](int depth) {
      const auto at = static_cast<std::uint32_t>(tree.size());
      tree.emplace_back();
      for (std::size_t i = 0; i < width && depth > 0; ++i) {
        const std::uint32_t child = grow(i % 2 == 0 ? depth - 1 : 0);
        tree[at].children.push_back(child);
        tree[at].items += tree[child].items;
      }
      if (depth == 0) tree[at].items = 1 + at % 4;
      return at;
    };
    grow(3);
    std::vector<DealtItem> items = random_items(tree[0].items, random);
    const double before = dealt_area(tree, items, 4);
    deal(tree, items);
    EXPECT_LT(dealt_area(tree, items, 4), before) << "they stood in no order";
    std::vector<DealtItem> again = items;
    deal(tree, again);
    std::vector<bool> found(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
      EXPECT_EQ(again[i].id, items[i].id) << "the order before does not matter";
      found[items[i].id] = true;
    }
    EXPECT_EQ(std::count(found.begin(), found.end(), false), 0);
  }
}

// Two places of one item, and one of five, which counts as two blocks: boxes of 1 x 1 x 1, and of 2 x 2 x 2.
TEST(Deal, AreasAreThoseOfNodesAndBlocks) {
  std::vector<DealtItem> items;
  for (std::uint32_t i = 0; i < 7; ++i) items.push_back({{Vec3{0}, Vec3{i < 2 ? 1.0f : 2.0f}}, i});
  EXPECT_EQ(dealt_area(flat({1, 1, 5}), items, 4), 3 + 3 + 2 * 12);
  EXPECT_EQ(dealt_area(flat({1, 1, 5}), items, 1), 3 + 3 + 5 * 12);
}

}  // namespace
}  // namespace carousel::accel::deal_test
