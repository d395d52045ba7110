#include "accel/structure/shape_array.h"

#include <utility>

#include <gtest/gtest.h>

namespace carousel::accel {
namespace {

ShapeArray<int> three_shapes() {
  ShapeArray<int> shapes;
  for (int i = 0; i < 3; ++i) shapes.push_back(10 + i);
  return shapes;
}

TEST(ShapeArray, KeepsItsElementsWhenItIsAssignedToItself) {
  ShapeArray<int> shapes = three_shapes();
  ShapeArray<int>& same = shapes;
  shapes = std::move(same);
  ASSERT_EQ(shapes.size(), 3u);
  EXPECT_EQ(shapes[2], 12);
  shapes = same;
  ASSERT_EQ(shapes.size(), 3u);
  EXPECT_EQ(shapes[2], 12);
}

TEST(ShapeArray, HasNoGapsOfItsOwnLeftWhenAnotherIsAssigned) {
  ShapeArray<int> shapes;
  shapes.allow_gaps(1000);
  shapes.push_back(1);
  shapes.skip(5);
  EXPECT_EQ(shapes.here(), 1u);
  const ShapeArray<int> others = three_shapes();
  shapes = others;
  EXPECT_EQ(shapes.size(), 3u);
  EXPECT_EQ(shapes.here(), 3u);
  shapes.push_back(13);
  EXPECT_EQ(shapes.parts().size(), 1u);
  EXPECT_EQ(shapes[3], 13);
}

}  // namespace
}  // namespace carousel::accel
