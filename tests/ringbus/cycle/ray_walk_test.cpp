// A ray's way through a tree: nearest first or in stored order, and what its stack moves.
#include "ringbus/cycle/tile/walk/ray_walk.h"

#include <bit>

#include <gtest/gtest.h>

#include "accel/traverse/ray_check.h"
#include "tests/ringbus/support/test_machine.h"

namespace carousel::ringbus::cycle {
namespace {

std::vector<RayRecord> records_of(TestScene& scene) {
  RayBatch rays;
  scene.new_workload()->generate(WorkerId(0), 1000, rays);
  std::vector<RayRecord> records(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) accel::start_record(rays[i], records[i]);
  return records;
}

std::uint64_t entry_bytes(accel::NodeKey key) {
  return key.ref.is_inner() ? 32 / 8 : 96 / 8;
}

TEST(RayWalk, PushesAllChildrenHitButTheNearest) {
  TestScene scene(builtin_scene(BuiltinScene::kCornell, 0, 0), 400, 3);
  BvhConfig large_leaves;
  large_leaves.leaf_triangles = 16;  // so that the root has some
  const accel::Accel& accel = scene.accel(large_leaves);
  std::vector<RayRecord> records = records_of(scene);
  int several = 0, leaves = 0, others = 0;
  for (std::uint32_t slot = 0; slot < records.size(); ++slot) {
    const accel::RayMembers ray{records.data(), &slot, 1};
    std::uint8_t mask = 0;
    float nearest[accel::kMaxWidth], entry[accel::kMaxWidth];
    std::fill(std::begin(nearest), std::end(nearest), kInfinity);
    IntersectionCounts counts;
    accel::test_strip(accel, accel.root_key(), ~0u, ray, {&mask, nearest, entry}, counts);
    TransformAccount transforms({}, accel, records.size());
    RayRecord again = records[slot];  // before the test of the walk
    const std::uint32_t first = 0;
    RayWalk stored(transforms, ChildOrder::kStored);
    RayWalk walk(transforms, ChildOrder::kNearest);
    walk.start(accel.root_key());
    ASSERT_EQ(walk.next(records[slot]), accel.root_key());
    EXPECT_EQ(walk.test(accel, accel.root_key(), ray), counts);
    const std::optional<accel::NodeKey> next = walk.next(records[slot]);
    ASSERT_EQ(next.has_value(), mask != 0);
    if (!next) continue;
    float least = kInfinity;
    std::uint64_t bytes = 0;
    bool among = false;
    for (std::uint32_t rest = mask; rest != 0; rest &= rest - 1) {
      const int lane = std::countr_zero(rest);
      least = std::min(least, entry[lane]);
      bytes += entry_bytes(accel.child_key(accel.root_key(), lane));
      leaves += !accel.child_key(accel.root_key(), lane).ref.is_inner();
    }
    for (std::uint32_t rest = mask; rest != 0; rest &= rest - 1) {
      const int lane = std::countr_zero(rest);
      among |= entry[lane] == least && accel.child_key(accel.root_key(), lane) == *next;
    }
    EXPECT_TRUE(among);
    stored.start(accel.root_key());
    ASSERT_EQ(stored.next(again), accel.root_key());
    stored.test(accel, accel.root_key(), {&again, &first, 1});
    const accel::NodeKey least_lane = accel.child_key(accel.root_key(), std::countr_zero(unsigned{mask}));
    EXPECT_EQ(stored.next(again), least_lane);
    EXPECT_EQ(stored.stack_bytes().held, bytes - entry_bytes(least_lane));
    others += *next != least_lane;
    EXPECT_EQ(walk.stack_bytes().pushed, bytes - entry_bytes(*next));
    EXPECT_EQ(walk.stack_bytes().held, walk.stack_bytes().pushed);
    EXPECT_EQ(walk.stack_bytes().popped, 0u);
    several += std::popcount(mask) > 1;
  }
  EXPECT_GT(several, 100);
  EXPECT_GT(others, 100);
  EXPECT_GT(leaves, 100);
}

class RayWalkInOrder : public ::testing::TestWithParam<ChildOrder> {};

TEST_P(RayWalkInOrder, FindsWhatTheKernelsFindAndLeavesNothingOnTheStack) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 300), 400, 0);
  const accel::Accel& accel = scene.accel(BvhConfig{});
  std::vector<RayRecord> records = records_of(scene), expected = records;
  std::uint64_t transforms = 0, by_strip = 0;
  TransformAccount account({}, accel, records.size());
  for (std::uint32_t slot = 0; slot < records.size(); ++slot) {
    IntersectionCounts ignored;
    accel::trace_subtree(accel, accel.root_key(), {expected.data(), &slot, 1}, ignored);
    RayWalk walk(account, GetParam());
    walk.start(accel.root_key());
    std::uint32_t last = kNoInstance;
    while (const std::optional<accel::NodeKey> key = walk.next(records[slot])) {
      const IntersectionCounts tests = walk.test(accel, *key, {records.data(), &slot, 1});
      transforms += tests.transforms;
      by_strip += key->instance != kNoInstance && !accel.instances[key->instance].transform.identity;
      // A ray is transformed when it comes to an instance, and kept while it stays there.
      EXPECT_TRUE(tests.transforms == 0 || key->instance != last);
      last = key->instance;
    }
    EXPECT_EQ(std::memcmp(&records[slot].hit, &expected[slot].hit, sizeof(Hit)), 0);
    EXPECT_EQ(walk.stack_bytes().held, 0u);
    EXPECT_EQ(walk.stack_bytes().popped, walk.stack_bytes().pushed);
  }
  EXPECT_GT(transforms, 0u);
  EXPECT_LT(transforms, by_strip);
}

INSTANTIATE_TEST_SUITE_P(Both, RayWalkInOrder, ::testing::Values(ChildOrder::kNearest, ChildOrder::kStored));

}  // namespace
}  // namespace carousel::ringbus::cycle
