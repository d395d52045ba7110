// No box that the exact ray meets is missed: what tests/accel/box/hard_box_test.cpp shows case by case, over boxes and
// rays made to be hard.
#include <cmath>
#include <iostream>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "accel/certificate/box_cases.h"
#include "accel/certificate/exact_box.h"
#include "tests/accel/box/box_levels.h"
#include "tests/accel/box/exact_entry.h"
#include "tests/accel/exact/adversarial_cases.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

float up(float x) {
  return std::nextafter(x, kInfinity);
}
float down(float x) {
  return std::nextafter(x, -kInfinity);
}

struct MissCount {
  int exact = 0;
  int off = 0;         // entries of level double further from the exact one than rounding up explains
  int early = 0;       // entries before the exact one, by the double's own rounding
  int missed[3] = {};  // by level
};

MissCount missed_boxes(int reach, int pace, std::uint64_t number) {
  Random random(1000 * std::uint64_t{run_seed()} + number);
  const int cases = adversarial_cases() / 4;
  MissCount count;
  for (int i = 0; i < cases; ++i) {
    const BoxCase c = box_case(random, reach, pace);
    if (c.ray.direction == Vec3{0} || !std::isfinite(c.ray.direction.x + c.ray.direction.y + c.ray.direction.z))
      continue;
    const ExactBox exact(c.ray, c.box, c.tmax);
    if (!exact.hit()) continue;
    ++count.exact;
    for (const auto& level : kEnumNames<BoxLevel>) {
      const BoxAnswer answer = box_answer(level.value, c.ray, c.box, c.tmax);
      count.missed[static_cast<int>(level.value)] += !answer.hit;
      if (level.value != BoxLevel::kDouble || !answer.hit || !(answer.entry < std::numeric_limits<float>::max()))
        continue;
      // Rounded up, but no further than a float and the double's own error.
      count.off += compare_entry(c.ray, c.box, up(answer.entry)) > 0;
      count.early += compare_entry(c.ray, c.box, answer.entry) > 0;
      count.off += answer.entry > 0 && compare_entry(c.ray, c.box, down(down(answer.entry))) < 0;
    }
  }
  std::cout << cases << " cases, " << count.exact << " boxes met: plain misses " << count.missed[0] << ", conservative "
            << count.missed[1] << ", double " << count.missed[2] << "; entered early " << count.early << "\n";
  return count;
}

TEST(BoxProperty, ConservativeAndDoubleMissNoBoxTheExactRayMeets) {
  SCOPED_TRACE("CAROUSEL_SEED=" + std::to_string(run_seed()));
  const MissCount count = missed_boxes(20, 10, 51);
  EXPECT_GT(count.exact, adversarial_cases() / 10);
  EXPECT_GT(count.missed[static_cast<int>(BoxLevel::kPlain)], count.exact / 1000);  // or nothing was hard
  EXPECT_EQ(count.missed[static_cast<int>(BoxLevel::kConservative)], 0);
  EXPECT_EQ(count.missed[static_cast<int>(BoxLevel::kDouble)], 0);
  EXPECT_EQ(count.off, 0);
  EXPECT_LE(count.early, count.exact / 10000);
}

// Distances below the normal floats, too, where a relative widening need not widen: conservative promises nothing
// there.
TEST(BoxProperty, DoubleMissesNoBoxOfAnyExponent) {
  SCOPED_TRACE("CAROUSEL_SEED=" + std::to_string(run_seed()));
  const MissCount count = missed_boxes(100, 140, 52);
  EXPECT_GT(count.exact, adversarial_cases() / 20);
  EXPECT_EQ(count.missed[static_cast<int>(BoxLevel::kDouble)], 0);
  EXPECT_EQ(count.off, 0);
  EXPECT_LE(count.early, count.exact / 10000);
}

}  // namespace
}  // namespace carousel::accel
