#include "shading/path/frame_paths.h"

#include <set>
#include <utility>

#include <gtest/gtest.h>

namespace carousel::shading {
namespace {

TEST(FramePaths, AreThePixelsAndSamplesOfTheFrame) {
  FramePaths paths(PixelOrder(5, 3, 2));
  ASSERT_EQ(paths.count(), 30u);
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  for (std::uint64_t i = 0; i < paths.count(); ++i) {
    const PixelSample at = paths.at(i);
    seen.emplace(at.y * 5 + at.x, at.sample);
  }
  EXPECT_EQ(seen.size(), 30u);
}

TEST(FramePaths, OfASampleAreThoseOfTheFrameInItsOrder) {
  const PixelOrder order(5, 3, 2);
  FramePaths paths(order);
  const PathSample sample({{4, 2, 0}, {20, 1, 1}});
  paths.set_sample(&sample);
  ASSERT_EQ(paths.count(), 3u);
  for (const auto& [i, ordinal] : {std::pair(0u, 4u), std::pair(1u, 5u), std::pair(2u, 20u)}) {
    EXPECT_EQ(paths.at(i).x, order.at(ordinal).x);
    EXPECT_EQ(paths.at(i).y, order.at(ordinal).y);
    EXPECT_EQ(paths.at(i).sample, order.at(ordinal).sample);
  }
  EXPECT_FALSE(paths.begin(2));
  EXPECT_TRUE(paths.begin(1));
  EXPECT_TRUE(paths.begin(0));
}

TEST(FramePaths, KnowOfRaysThatAreHeldBack) {
  FramePaths paths(PixelOrder(1, 1, 1));
  EXPECT_TRUE(paths.none_held());
  paths.hold();
  EXPECT_TRUE(paths.begin(1));
  EXPECT_FALSE(paths.none_held());
  paths.release();
  EXPECT_TRUE(paths.none_held());
}

}  // namespace
}  // namespace carousel::shading
