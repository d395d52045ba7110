// The order in which the children that a ray hits are put on its stack.
#include "ringbus/resource/visit/last_first.h"

#include <vector>

#include <gtest/gtest.h>

namespace carousel::ringbus {
namespace {

constexpr float kEntriesOfSix[] = {3, 1, 3, 1, 0, 2};

std::vector<int> lanes_as_pushed(ChildOrder order, std::uint32_t mask) {
  std::vector<int> lanes;
  last_first(order, mask, kEntriesOfSix, [&](int lane) { lanes.push_back(lane); });
  return lanes;
}

// A ray that starts within several boxes enters them all at the same distance.
TEST(LastFirst, PutsTheNearestOnTopAndOfEqualOnesTheLeastLane) {
  EXPECT_EQ(lanes_as_pushed(ChildOrder::kNearest, 0b111111), (std::vector<int>{2, 0, 5, 3, 1, 4}));
  EXPECT_EQ(lanes_as_pushed(ChildOrder::kNearest, 0b001011), (std::vector<int>{0, 3, 1}));
}

TEST(LastFirst, PutsTheLeastLaneOnTopInStoredOrder) {
  EXPECT_EQ(lanes_as_pushed(ChildOrder::kStored, 0b111111), (std::vector<int>{5, 4, 3, 2, 1, 0}));
  EXPECT_EQ(lanes_as_pushed(ChildOrder::kStored, 0b110010), (std::vector<int>{5, 4, 1}));
}

TEST(LastFirst, PutsNothingWhereNothingIsHit) {
  for (const ChildOrder order : {ChildOrder::kNearest, ChildOrder::kStored})
    EXPECT_TRUE(lanes_as_pushed(order, 0).empty());
}

}  // namespace
}  // namespace carousel::ringbus
