#include "ringbus/cycle/tile/stages/rays_in_test.h"

#include <gtest/gtest.h>

namespace carousel::ringbus::cycle {
namespace {

struct Handed {
  HitBatch done;
  std::vector<std::uint32_t> slots;

  void take(RaysInTest& in_test, std::vector<std::uint32_t> completed) {
    HitBatch rays(completed.size());
    in_test.hand_over(rays, completed, done, slots);
  }
};

// Two contexts test the ray in slot 3. The visit that began last brought its count to zero, and ends first.
TEST(RaysInTest, ARayCompletesWithTheLastVisitThatTestsIt) {
  RaysInTest in_test(8, true);
  std::vector<std::uint32_t> slow, fast;
  in_test.begin(std::vector<std::uint32_t>{3, 5}, slow);
  in_test.begin(std::vector<std::uint32_t>{3, 6}, fast);
  Handed handed;
  in_test.end(fast);
  handed.take(in_test, {3, 6});
  EXPECT_EQ(handed.slots, (std::vector<std::uint32_t>{6}));
  in_test.end(slow);
  handed.take(in_test, {5});
  EXPECT_EQ(handed.slots, (std::vector<std::uint32_t>{6, 3, 5}));
  EXPECT_EQ(handed.done.size(), 3u);
}

TEST(RaysInTest, WithOneContextEveryRayIsHandedOverAtOnce) {
  RaysInTest in_test(8, false);
  std::vector<std::uint32_t> visit;
  in_test.begin(std::vector<std::uint32_t>{3}, visit);
  in_test.end(visit);
  Handed handed;
  handed.take(in_test, {3});
  EXPECT_EQ(handed.slots, (std::vector<std::uint32_t>{3}));
}

}  // namespace
}  // namespace carousel::ringbus::cycle
