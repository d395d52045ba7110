#include "ringbus/cycle/shapes/triangle_strips.h"

#include <vector>

#include <gtest/gtest.h>

namespace carousel::ringbus::cycle {
namespace {

Corner corner(std::uint32_t x, std::uint32_t y) {
  return {x, y, 0};
}

/// Two triangles a square, `squares` in a row.
std::vector<StripTriangle> row(std::uint32_t squares) {
  std::vector<StripTriangle> out;
  for (std::uint32_t i = 0; i < squares; ++i) {
    out.push_back({corner(i, 0), corner(i + 1, 0), corner(i, 1)});
    out.push_back({corner(i + 1, 0), corner(i + 1, 1), corner(i, 1)});
  }
  return out;
}

TEST(TriangleStrips, ShareTheVerticesOfARow) {
  EXPECT_EQ(triangle_strips(row(1)), (StripCounts{1, 4}));
  EXPECT_EQ(triangle_strips(row(8)), (StripCounts{1, 18}));
  std::vector<StripTriangle> shuffled = row(4);
  std::swap(shuffled[0], shuffled[5]);
  std::swap(shuffled[2][0], shuffled[2][1]);
  EXPECT_EQ(triangle_strips(shuffled), (StripCounts{1, 10}));
}

TEST(TriangleStrips, HaveThreeVerticesEachWhereNothingIsShared) {
  EXPECT_EQ(triangle_strips(std::vector<StripTriangle>{}), (StripCounts{0, 0}));
  const StripTriangle one = row(1)[0], away = row(4)[7], touching{corner(1, 0), corner(9, 9), corner(9, 8)};
  EXPECT_EQ(triangle_strips(std::vector{one}), (StripCounts{1, 3}));
  EXPECT_EQ(triangle_strips(std::vector{one, away}), (StripCounts{2, 6}));
  EXPECT_EQ(triangle_strips(std::vector{one, touching}), (StripCounts{2, 6})) << "one vertex is no edge";
}

// Four triangles round a vertex: a strip turns left and right by turns, so it takes three of a fan at most.
TEST(TriangleStrips, DoNotGoRoundAFan) {
  const Corner centre = corner(5, 5);
  const std::vector<Corner> rim{corner(0, 0), corner(1, 0), corner(2, 0), corner(3, 0), corner(4, 0)};
  std::vector<StripTriangle> fan;
  for (std::size_t i = 0; i < 4; ++i) fan.push_back({centre, rim[i], rim[i + 1]});
  EXPECT_EQ(triangle_strips(fan), (StripCounts{2, 8}));
}

}  // namespace
}  // namespace carousel::ringbus::cycle
