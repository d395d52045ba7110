// Frames beside the ray slots of their machine.
#include "ringbus/verdict/small_frame.h"

#include <gtest/gtest.h>

namespace carousel::ringbus {
namespace {

/// A run whose last path begins after `begun` completed rays.
cycle::CycleResult run_with(std::uint64_t begun) {
  cycle::CycleResult out;
  out.all_begun = {1000, begun, {}};
  return out;
}

TEST(SmallFrame, HasLessThanThreeQuartersOfItsRaysBetweenFillAndDrain) {
  // 100 slots are full after 200 rays.
  EXPECT_FALSE(small_frame(run_with(950), 1000, 500, 100));
  const auto small = small_frame(run_with(949), 1000, 500, 100);
  ASSERT_TRUE(small);
  EXPECT_EQ(small->paths, 500);
  EXPECT_EQ(small->slots, 100);
  EXPECT_DOUBLE_EQ(small->between, 0.749);
  // 200 rays fill it and 51 drain it: four times as many, of two rays a path.
  EXPECT_EQ(small->least_paths, 510);
}

TEST(SmallFrame, ThatNeverFillsItsMachineNeedsAtLeastItsSlots) {
  const auto small = small_frame(run_with(0), 100, 50, 1000);
  ASSERT_TRUE(small);
  EXPECT_EQ(small->between, 0);
  // 2,000 rays fill the machine, and a full one has 2,000 to drain.
  EXPECT_EQ(small->least_paths, 8000);
}

TEST(SmallFrame, TheSizeThatIsToldWouldDo) {
  for (const std::uint64_t slots : {64, 500, 8192}) {
    const auto small = small_frame(run_with(3 * slots), 6 * slots, 2 * slots, slots);
    ASSERT_TRUE(small);
    const std::uint64_t rays = 3 * small->least_paths;
    EXPECT_FALSE(small_frame(run_with(rays - 3 * slots), rays, small->least_paths, slots)) << slots;
  }
}

TEST(SmallFrame, IsNotSaidOfARunThatDoesNotKnowWhenItsLastPathBegan) {
  EXPECT_FALSE(small_frame({}, 1000, 500, 100));
}

}  // namespace
}  // namespace carousel::ringbus
