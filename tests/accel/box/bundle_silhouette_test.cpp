#include "accel/box/bundle_silhouette.h"

#include <iostream>
#include <string>
#include <utility>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "accel/box/bundle_intersect.h"
#include "accel/box/bundle_interval.h"
#include "accel/box/slab.h"
#include "accel/certificate/adversarial_numbers.h"
#include "core/config/config.h"
#include "core/types/enum_names.h"
#include "tests/accel/box/bundle_cases.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

using Edges = BundlesConfig::Edges;
using Order = BundlesConfig::Order;

/// A narrow bundle from `eye` towards `aim`.
std::vector<Ray> towards(const Vec3& aim, const Vec3& eye, float end = kInfinity) {
  const Vec3 d = aim - eye;
  return {ray(eye, d, end), ray(eye, d + Vec3{0x1p-10f}, end)};
}

BundleAnswer test(const std::vector<Ray>& rays, Order order, Edges edges = Edges::kSerial, const Aabb& box = kUnit) {
  Accel accel;
  Node node;
  set_child(node, 0, box);
  BundlesConfig config;
  config.form = BundlesConfig::Form::kSilhouette;
  config.order = order;
  config.edges = edges;
  IntersectionCounts counts;
  const BundleAnswer answer = test_bundle(accel, node, 1, record_of(rays), config, counts);
  EXPECT_GE(counts.bundle, 1u);
  return answer;
}

TEST(BundleSilhouette, HasFourEdgesWhereOneFaceIsSeenAndSixOfMore) {
  struct Expected {
    Vec3 eye;
    int edges;
  };
  for (const Expected& e : {Expected{{0, 0, -4}, 4},
                            {{0, 4, 0}, 4},
                            {{-4, 0, -4}, 6},
                            {{4, 3, -4}, 6},
                            {{-4, -4, -4}, 6},
                            {{0, 0, 0}, 0}}) {
    for (const Edges edges : {Edges::kSerial, Edges::kParallel}) {
      const BundleAnswer answer = test(towards({0.2f, 0.3f, 0.25f}, e.eye), Order::kAllHitOnly, edges);
      EXPECT_EQ(answer.all, 1) << e.eye.x << " " << e.eye.y << " " << e.eye.z;
      EXPECT_EQ(answer.edges, e.edges) << e.eye.x << " " << e.eye.y << " " << e.eye.z;
    }
  }
}

TEST(BundleSilhouette, OneAfterAnotherStopsAtTheFirstEdgeThatDecides) {
  const std::vector<Ray> past = towards({-3, 2.5f, 0}, {-4, -4, -4});  // leaves y before it enters x
  for (const Order order : {Order::kAnyHitOnly, Order::kAllHitOnly}) {
    const BundleAnswer serial = test(past, order, Edges::kSerial), parallel = test(past, order, Edges::kParallel);
    EXPECT_EQ(serial.edges, 1) << enum_name(order);
    EXPECT_EQ(parallel.edges, 6) << enum_name(order);
    EXPECT_EQ(serial.all, 0) << enum_name(order);
    EXPECT_EQ(parallel.all, 0) << enum_name(order);
    EXPECT_EQ(serial.undecided, parallel.undecided) << enum_name(order);
  }
}

TEST(BundleSilhouette, BothTestsCountTheirEdges) {
  EXPECT_EQ(test(towards({0, 0, 0}, {-4, -4, -4}), Order::kParallel).edges, 12);
  EXPECT_EQ(test(towards({0, 0, 0}, {-4, -4, -4}), Order::kAllHitFirst).edges, 6);
}

// Intervals divide for both ends of three directions at each node, silhouettes for the distance of a box that all hit.
TEST(BundleSilhouette, DividesForDistancesAlone) {
  Accel accel;
  Node node;
  set_child(node, 0, kUnit);
  set_child(node, 1, {{2, 2, 2}, {3, 3, 3}});
  const std::vector<Ray> hits = towards({0, 0, 0}, {-4, 0.5f, 0.25f}), misses = towards({0, 9, 0}, {-4, 9, 9});
  for (const auto& [rays, hit] : {std::pair{hits, 1u}, std::pair{misses, 0u}}) {
    for (const auto form : {BundlesConfig::Form::kInterval, BundlesConfig::Form::kSilhouette}) {
      BundlesConfig config;
      config.form = form;
      IntersectionCounts counts;
      const BundleAnswer answer = test_bundle(accel, node, 3, record_of(rays), config, counts);
      const bool silhouettes = form == BundlesConfig::Form::kSilhouette;
      EXPECT_EQ(answer.all, hit);
      EXPECT_EQ(answer.silhouettes, silhouettes);
      EXPECT_EQ(counts.silhouettes, silhouettes ? counts.bundle : 0u);
      EXPECT_EQ(counts.edges, answer.edges);
      EXPECT_EQ(counts.reciprocals, silhouettes ? hit : 6u);
    }
  }
}

TEST(BundleSilhouette, NeedsNoEdgeForBoxesBehindOrBeyondTheRange) {
  for (const BundleAnswer& answer : {test(towards({0, 0, 9}, {0, 0, 4}), Order::kAnyHitFirst),
                                     test(towards({0, 0, 0}, {0, 0, -4}, 0.5f), Order::kAnyHitFirst)}) {
    EXPECT_EQ(answer.all | answer.undecided, 0);
    EXPECT_EQ(answer.edges, 0);
  }
}

// With "<" for "<=" every ray along an axis would be lost.
TEST(BundleSilhouette, RaysAlongAnAxisHitWhereTheyTouch) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {1.0f, -1.0f}) {
      for (const float zero : {0.0f, -0.0f}) {
        std::vector<Ray> rays;
        for (const float side : {-1.0f, 1.0f}) {
          Ray r = ray(Vec3{side}, Vec3{zero});
          r.origin[axis] = -4 * sign;
          r.direction[axis] = sign;
          rays.push_back(r);
        }
        EXPECT_EQ(test(rays, Order::kAllHitOnly).all, 1);
        EXPECT_EQ(test(rays, Order::kAnyHitFirst).all, 1);
        for (Ray& r : rays) r.origin[(axis + 1) % 3] = 1.5f;
        EXPECT_EQ(test(rays, Order::kAnyHitOnly).all, 0);
      }
    }
  }
}

TEST(BundleSilhouette, LeavesWhatItIsNotForToIntervals) {
  const auto applies = [](const std::vector<Ray>& rays) { return BundleSilhouette::applies(record_of(rays)); };
  EXPECT_TRUE(applies(towards({0, 0, 0}, {-4, -4, -4})));
  EXPECT_FALSE(applies({ray({0, 0, -4}, {-0.1f, 0, 1}), ray({0, 0, -4}, {0.1f, 0, 1})}));
  EXPECT_FALSE(applies({ray({0, 0, -4}, {0.0f, 0, 1}), ray({0, 0, -4}, {-0.0f, 0, 1})}));
  EXPECT_FALSE(applies({ray({0, 0, -4}, {1e-38f, 0, 1}), ray({0, 0, -4}, {1e-40f, 0, 1})}));
  EXPECT_FALSE(applies({ray({0, 0, -4}, {1e38f, 0, 1}), ray({0, 0, -4}, {1, 0, 1})}));
  const BundleAnswer mixed = test({ray({0, 0, -4}, {-0.1f, 0, 1}), ray({0, 0, -4}, {0.1f, 0, 1})}, Order::kAllHitOnly);
  EXPECT_EQ(mixed.all, 1);
  EXPECT_EQ(mixed.edges, 0);
  EXPECT_EQ(test({ray({-4, -4, -4}, {1, 1, 1})}, Order::kAllHitOnly).edges, 0);  // one ray
}

// The slab test finds boxes hit where all distances are below the least float.
TEST(BundleSilhouette, ClaimsNothingOfDistancesThatUnderflow) {
  const float s = 0x1p-100f, pace = 0x1p60f;
  const std::vector<Ray> fast{ray(Vec3{0}, {pace, pace, 0}), ray(Vec3{0}, {pace, pace, 0})};
  ASSERT_TRUE(BundleSilhouette::applies(record_of(fast)));
  for (const Aabb& box : {Aabb{{s, -s, -s}, {2 * s, s / 4, s}}, Aabb{{-2 * s, -s, -s}, {-s, s, s}}}) {
    float entry;
    ASSERT_TRUE(slab(SlabRay(fast[0]), box, kInfinity, entry));
    const BundleAnswer answer = test(fast, Order::kAnyHitFirst, Edges::kSerial, box);
    EXPECT_NE(answer.all | answer.undecided, 0);
  }
  // At a slower pace they are what they are: missed.
  const std::vector<Ray> slow{ray(Vec3{0}, {1, 1, 0}), ray(Vec3{0}, {1, 1, 0})};
  for (const Aabb& box : {Aabb{{4 * s, -s, -s}, {8 * s, s, s}}, Aabb{{-4 * s, -s, -s}, {-2 * s, s, s}}})
    EXPECT_EQ(test(slow, Order::kAnyHitFirst, Edges::kSerial, box).undecided, 0);
}

// Both take the same ranges to their ends; only the slack and rounding differ.
TEST(BundleSilhouette, SettlesWhatIntervalsSettle) {
  SCOPED_TRACE("CAROUSEL_SEED=" + std::to_string(run_seed()));
  Random random(1000 * std::uint64_t{run_seed()} + 90);
  const BoxPlanes<float> unit = planes_of<float>(kUnit);
  int boxes = 0, by_interval = 0, by_silhouette = 0;
  for (int i = 0; i < 100000; ++i) {
    const Vec3 eye = random.uniform(2, 30) * Vec3(random_direction(random)),
               apart = Vec3{random.below(2) ? 0.0f : 0.1f};
    const Vec3 aim = random.in_box(Vec3{-2}, Vec3{2});
    std::vector<Ray> rays;
    for (int k = 0; k < 16; ++k) {
      const Vec3 from = eye + random.in_box(-apart, apart);
      rays.push_back(ray(from, aim + random.in_box(Vec3{-0.05f}, Vec3{0.05f}) - from, random.uniform(0.5f, 2)));
    }
    const BundleRecord record = record_of(rays);
    if (!BundleSilhouette::applies(record)) continue;
    const BundleInterval<float> interval(record, kFarWidening);
    const BundleSilhouette silhouette(record, BoxLevel::kConservative, Edges::kSerial);
    unsigned edges = 0;
    const bool all = silhouette.all_hit(kUnit, edges), none = silhouette.all_miss(kUnit, edges);
    ++boxes;
    const bool all_hit = interval.all_hit(unit), all_miss = interval.all_miss(unit);
    by_interval += all_hit || all_miss;
    by_silhouette += all || none;
    ASSERT_FALSE(all && all_miss) << i;
    ASSERT_FALSE(none && all_hit) << i;
  }
  std::cout << boxes << " boxes, settled by intervals " << by_interval << ", by silhouettes " << by_silhouette << "\n";
  EXPECT_GT(boxes, 80000);
  EXPECT_GT(by_silhouette, boxes / 2);
  EXPECT_NEAR(by_silhouette, by_interval, boxes / 1000);
}

}  // namespace
}  // namespace carousel::accel
