// The hard cases of a ray and a box, each at every level and on every SIMD target, judged by big integers.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "accel/certificate/exact_box.h"
#include "tests/accel/box/box_levels.h"
#include "tests/accel/box/exact_entry.h"

namespace carousel::accel {
namespace {

constexpr Aabb kUnit{{-1, -1, -1}, {1, 1, 1}};
const float kDenormal = std::numeric_limits<float>::denorm_min();

Ray ray(const Vec3& origin, const Vec3& direction, float tmin = 0) {
  Ray r;
  r.origin = origin;
  r.direction = direction;
  r.tmin = tmin;
  return r;
}
float next_up(float x) {
  return std::nextafter(x, kInfinity);
}
float next_down(float x) {
  return std::nextafter(x, -kInfinity);
}

// Expects the same hit at every level and from exact arithmetic.
void expect_hit(const Ray& r, const Aabb& box, float entry, float tmax = kInfinity) {
  const ExactBox exact(r, box, tmax);
  EXPECT_TRUE(exact.hit());
  EXPECT_EQ(compare_entry(r, box, entry), 0);
  for (const auto& level : kEnumNames<BoxLevel>) {
    const BoxAnswer answer = box_answer_everywhere(level.value, r, box, tmax);
    EXPECT_TRUE(answer.hit) << level.name;
    EXPECT_EQ(answer.entry, entry) << level.name;
  }
}
void expect_miss(const Ray& r, const Aabb& box, float tmax = kInfinity) {
  EXPECT_FALSE(ExactBox(r, box, tmax).hit());
  for (const auto& level : kEnumNames<BoxLevel>)
    EXPECT_FALSE(box_answer_everywhere(level.value, r, box, tmax).hit) << level.name;
}

TEST(HardBox, AxisParallelThroughTheBox) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float zero : {0.0f, -0.0f}) {
      for (const float sign : {-1.0f, 1.0f}) {
        Ray r = ray({0.5f, 0.5f, 0.5f}, Vec3{zero});
        r.origin[axis] = -3 * sign;
        r.direction[axis] = sign;
        expect_hit(r, kUnit, 2);
      }
    }
  }
}

TEST(HardBox, AlongAnEdge) {
  for (int axis = 0; axis < 3; ++axis)
    for (const float a : {-1.0f, 1.0f})
      for (const float b : {-1.0f, 1.0f})
        for (const float zero : {0.0f, -0.0f})
          for (const float sign : {-1.0f, 1.0f}) {
            Ray r = ray(Vec3{0}, Vec3{zero});
            r.origin[axis] = -3 * sign;
            r.origin[(axis + 1) % 3] = a;
            r.origin[(axis + 2) % 3] = b;
            r.direction[axis] = sign;
            expect_hit(r, kUnit, 2);
          }
}

TEST(HardBox, ThroughACornerOnly) {
  expect_hit(ray({-2, -2, 0}, {1, 1, 1}), {{-1, -1, 1}, {1, 1, 3}}, 1);
  expect_hit(ray({-3, 1, 0}, {2, 1, 0.5f}), {{-1, 2, 0.5f}, {1, 2, 1}}, 1);
  expect_hit(ray({2, -2, 0}, {-1, 1, 0}), {{0, -2, 0}, {1, -1, 0}}, 1);  // in at one corner, out at it
  expect_miss(ray({2, -2, 0}, {-1, 1 + 0x1p-10f, 0}), {{0, -2, 0}, {1, -1, 0}});
}

TEST(HardBox, DirectionsOfOneComponentFromOutsideASlab) {
  expect_miss(ray({2, 0, -3}, {0, 0, 1}), kUnit);
  expect_miss(ray({0, -2, -3}, {0, 0, 1}), kUnit);
  expect_miss(ray({2, -3, 0}, {0, 1, 0}), kUnit);
  expect_miss(ray({0, -3, -2}, {0, 1, 0}), kUnit);
  expect_miss(ray({next_up(1), 0, -3}, {0, 0, 1}), kUnit);
  expect_miss(ray({0, -3, next_down(-1)}, {-0.0f, 1, -0.0f}), kUnit);
}

TEST(HardBox, BoxBehindTheOrigin) {
  expect_miss(ray({0, 0, 3}, {0, 0, 1}), kUnit);
  expect_miss(ray({3, 3, 3}, {1, 0.5f, 0.25f}), kUnit);
  expect_miss(ray({0, 0, next_up(1)}, {0, 0, 1}), kUnit);
}

TEST(HardBox, MixedNearAndFarSigns) {
  // Every pattern of signs, through the middle and past it.
  for (int signs = 0; signs < 8; ++signs) {
    const Vec3 s{signs & 1 ? -1.0f : 1.0f, signs & 2 ? -1.0f : 1.0f, signs & 4 ? -1.0f : 1.0f};
    expect_hit(ray(s * -4.0f, s), kUnit, 3);
    expect_hit(ray({-4 * s.x, -4 * s.y, -2.5f * s.z}, {s.x, s.y, 0.5f * s.z}), kUnit, 3);
    expect_miss(ray({-4 * s.x, -4 * s.y, 4 * s.z}, s), kUnit);
  }
}

TEST(HardBox, OriginInside) {
  expect_hit(ray({0.5f, 0, 0}, {0.3f, -0.2f, 0.9f}), kUnit, 0);
  expect_hit(ray({0.5f, 0, 0}, {0, -0.0f, 1}), kUnit, 0);
  expect_hit(ray({0.5f, 0, 0}, {0.3f, -0.2f, 0.9f}, 0.25f), kUnit, 0.25f);
}

TEST(HardBox, OriginOnTheEntryFace) {
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {-1.0f, 1.0f}) {
      Ray r = ray(Vec3{0.25f}, Vec3{0.125f});
      r.origin[axis] = -sign;
      r.direction[axis] = sign;
      expect_hit(r, kUnit, 0);
    }
}

TEST(HardBox, OriginOnTheExitFaceLeaving) {
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {-1.0f, 1.0f}) {
      Ray r = ray(Vec3{0.25f}, Vec3{0.125f});
      r.origin[axis] = sign;
      r.direction[axis] = sign;
      expect_hit(r, kUnit, 0);
      r.tmin = kDenormal;  // anything later is outside
      expect_miss(r, kUnit);
    }
}

TEST(HardBox, FlatBox) {
  const Aabb flat{{-1, -1, 0}, {1, 1, 0}};
  expect_hit(ray({0, 0, -1}, {0, 0, 1}), flat, 1);
  expect_hit(ray({-2, 0, 0}, {1, 0, 0}), flat, 1);      // in its plane
  expect_hit(ray({-2, 1, 0}, {1, 0, -0.0f}), flat, 1);  // along its edge
  expect_hit(ray({0, 0, 0}, {1, 1, 1}), flat, 0);
  expect_miss(ray({-2, 0, kDenormal}, {1, 0, 0}), flat);
}

TEST(HardBox, PointBox) {
  expect_hit(ray({-2, 0, 0}, {1, 0, 0}), {Vec3{0}, Vec3{0}}, 2);
  expect_hit(ray({1, 2, 3}, {1, 2, 3}), {{2, 4, 6}, {2, 4, 6}}, 1);
  expect_hit(ray({2, 4, 6}, {1, 2, 3}), {{2, 4, 6}, {2, 4, 6}}, 0);
  expect_miss(ray({-2, 0.001f, 0.001f}, {1, 1e-9f, 0}), {Vec3{0}, Vec3{0}});
}

TEST(HardBox, TmaxExactlyOnTheEntryFace) {
  expect_hit(ray({0, 0, -3}, {0, 0, 1}), kUnit, 2, 2.0f);
}
TEST(HardBox, TmaxOneUlpShortOfTheEntryFace) {
  expect_miss(ray({0, 0, -3}, {0, 0, 1}), kUnit, next_down(2));
}

TEST(HardBox, TminOnAndOneUlpPastTheExit) {
  expect_hit(ray({0, 0, -3}, {0, 0, 1}, 4), kUnit, 4);
  const Ray past = ray({0, 0, -3}, {0, 0, 1}, next_up(4));
  EXPECT_FALSE(ExactBox(past, kUnit, kInfinity).hit());
  EXPECT_FALSE(box_answer_everywhere(BoxLevel::kPlain, past, kUnit).hit);
  // The far side is widened on purpose, by 2^-20 of the distance and no more.
  for (const BoxLevel level : {BoxLevel::kConservative, BoxLevel::kDouble})
    EXPECT_TRUE(box_answer_everywhere(level, past, kUnit).hit) << enum_name(level);
  expect_miss(ray({0, 0, -3}, {0, 0, 1}, 4 * (1 + 0x1p-19f)), kUnit);
}

TEST(HardBox, TmaxInfiniteWithAZeroComponent) {
  for (const float zero : {0.0f, -0.0f}) {
    expect_hit(ray({0, 1, -3}, {zero, zero, 1}), kUnit, 2, kInfinity);
    expect_miss(ray({0, next_up(1), -3}, {zero, zero, 1}), kUnit, kInfinity);
    expect_miss(ray({-1, next_down(-1), 0}, {zero, zero, 1}), kUnit, kInfinity);
  }
}

TEST(HardBox, ProductsThatUnderflow) {
  const float s = 0x1p-83f;  // 1e-25
  const Aabb box{Vec3{-s}, Vec3{s}};
  expect_hit(ray(Vec3{-3 * s, -3 * s, -3 * s}, Vec3{s, s, s}), {Vec3{-2 * s}, Vec3{2 * s}}, 1);
  expect_miss(ray({-3 * s, 2 * s, 0}, {s, 0, 0}), box);
  expect_miss(ray({-3 * s, -3 * s, 0}, {s, 4 * s, 0}), box);
  // Across such a box at a great pace: distances below every float but zero.
  for (const BoxLevel level : {BoxLevel::kConservative, BoxLevel::kDouble}) {
    EXPECT_TRUE(box_answer_everywhere(level, ray({-3 * s, 0, 0}, {1e25f, 0, 0}), box).hit);
    EXPECT_FALSE(box_answer_everywhere(level, ray({-3 * s, 2 * s, 0}, {1e25f, 0, 0}), box).hit);
  }
}

TEST(HardBox, ProductsThatOverflow) {
  const float s = 0x1p83f;  // 1e25
  const Aabb box{Vec3{-2 * s}, Vec3{2 * s}};
  expect_hit(ray(Vec3{-3 * s}, Vec3{s}), box, 1);
  expect_miss(ray({-3 * s, 4 * s, 0}, {s, 0, 0}), box);
  expect_miss(ray({-3 * s, -3 * s, 0}, {s, 8 * s, 0}), box);
  // 2e50 is beyond every float: nothing is entered before a finite tmax, and no level may say otherwise.
  expect_miss(ray({-4 * s, 0, 0}, {1e-25f, 0, 0}), box, std::numeric_limits<float>::max());
  for (const auto& level : kEnumNames<BoxLevel>)
    EXPECT_TRUE(box_answer_everywhere(level.value, ray({-4 * s, 0, 0}, {1e-25f, 0, 0}), box).hit) << level.name;
}

TEST(HardBox, ZeroComponentsOfBothSignsWithTheOriginOnAFace) {
  for (const float x : {0.0f, -0.0f})
    for (const float y : {0.0f, -0.0f})
      for (const float face : {-1.0f, 1.0f}) {
        expect_hit(ray({face, 0, -3}, {x, y, 1}), kUnit, 2);
        expect_hit(ray({0, face, -3}, {x, y, 1}), kUnit, 2);
        expect_hit(ray({face, face, 0}, {x, y, -1}), kUnit, 0);
        expect_miss(ray({face, 2 * face, -3}, {x, y, 1}), kUnit);
      }
}

TEST(HardBox, DenormalDirection) {
  const float tiny = 1e-40f;
  for (const float sign : {-1.0f, 1.0f}) {
    // The side component is too slow to matter before the box is left.
    expect_hit(ray({1, 0, -3}, {-sign * tiny * 0.0f, sign * tiny, 1}), kUnit, 2);
    for (const auto& level : kEnumNames<BoxLevel>) {
      EXPECT_TRUE(box_answer_everywhere(level.value, ray({sign, 0, -3}, {sign * tiny, 0, 1}), kUnit).hit ||
                  !ExactBox(ray({sign, 0, -3}, {sign * tiny, 0, 1}), kUnit, kInfinity).hit())
          << level.name;
      // Nothing but a denormal component: entered at 2e40, later than every float.
      EXPECT_TRUE(box_answer_everywhere(level.value, ray({-3 * sign, 0, 0}, {sign * tiny, 0, 0}), kUnit).hit)
          << level.name;
    }
  }
  // Entered at 1e37, which is a float.
  const Ray r = ray({-1.001f, 0, 0}, {tiny, 0, 0});
  for (const auto& level : kEnumNames<BoxLevel>) {
    const BoxAnswer answer = box_answer_everywhere(level.value, r, kUnit, 1e38f);
    EXPECT_TRUE(answer.hit) << level.name;
    EXPECT_LE(answer.entry, 1.1e37f) << level.name;
  }
}

}  // namespace
}  // namespace carousel::accel
