#include "accel/box/bundle_interval.h"

#include <bit>
#include <cmath>
#include <iostream>
#include <limits>
#include <string>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "accel/box/bundle_intersect.h"
#include "accel/certificate/box_cases.h"
#include "accel/certificate/exact_box.h"
#include "core/config/config.h"
#include "core/types/enum_names.h"
#include "tests/accel/box/box_levels.h"
#include "tests/accel/box/bundle_cases.h"
#include "tests/accel/exact/adversarial_cases.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

using Order = BundlesConfig::Order;
enum class Verdict { kMiss, kAll, kUndecided };

void PrintTo(Verdict verdict, std::ostream* out) {
  constexpr const char* kNames[] = {"all miss", "all hit", "undecided"};
  *out << kNames[static_cast<int>(verdict)];
}

Verdict verdict(const BundleAnswer& answer, int lane) {
  if (answer.all >> lane & 1) return Verdict::kAll;
  return answer.undecided >> lane & 1 ? Verdict::kUndecided : Verdict::kMiss;
}

/// The answer of every level, which must be of one mind.
Verdict verdict(const std::vector<Ray>& rays, const Aabb& box, bool strict = false) {
  BundlesConfig config;
  config.strict = strict;
  Verdict first{};
  for (const auto& level : kEnumNames<BoxLevel>) {
    Accel accel;
    accel.accuracy.box = level.value;
    Node node;
    set_child(node, 0, box);
    IntersectionCounts counts;
    const Verdict found = verdict(test_bundle(accel, node, 1, record_of(rays), config, counts), 0);
    if (level.value == BoxLevel::kPlain) first = found;
    EXPECT_EQ(found, first) << level.name;
  }
  return first;
}

TEST(BundleInterval, SaysWhatIsPlain) {
  const Vec3 eye{0, 0, -4};
  const auto aside = [&](float x) { return ray(eye, {x, 0.1f, 1}); };
  for (const bool strict : {false, true}) {
    EXPECT_EQ(verdict({aside(0.1f), aside(0.2f)}, kUnit, strict), Verdict::kAll);
    EXPECT_EQ(verdict({aside(0.4f), aside(0.5f)}, kUnit, strict), Verdict::kMiss);
    EXPECT_EQ(verdict({aside(0.2f), aside(0.5f)}, kUnit, strict), Verdict::kUndecided);
    EXPECT_EQ(verdict({ray({0, 0, 4}, {0, 0.1f, 1}), ray({0, 0, 5}, {0, 0.1f, 1})}, kUnit, strict), Verdict::kMiss);
  }
}

TEST(BundleInterval, SignsMayBeMixed) {
  // Across the middle of a face, and about an axis beside the box.
  EXPECT_EQ(verdict({ray({0, 0, -4}, {-0.2f, 0.1f, 1}), ray({0, 0, -4}, {0.2f, -0.1f, 1})}, kUnit), Verdict::kAll);
  EXPECT_EQ(verdict({ray({3, 0, -4}, {-0.2f, 0.1f, 1}), ray({3, 0, -4}, {0.2f, -0.1f, 1})}, kUnit), Verdict::kMiss);
  EXPECT_EQ(verdict({ray({3, 0, -4}, {-0.9f, 0.1f, 1}), ray({3, 0, -4}, {0.2f, -0.1f, 1})}, kUnit),
            Verdict::kUndecided);
  // From inside, wherever they go.
  EXPECT_EQ(verdict({ray({0, 0, 0}, {-1, 1, 1}), ray({0.5f, 0, 0}, {1, -1, -1})}, kUnit), Verdict::kAll);
  // One goes there, one goes away.
  EXPECT_EQ(verdict({ray({0, 0, -4}, {0, 0, 1}), ray({0, 0, -4}, {0, 0, -1})}, kUnit), Verdict::kUndecided);
}

TEST(BundleInterval, ZerosOfBothSignsAreDirectionsBesideTheBoxOrInIt) {
  for (const float first : {0.0f, -0.0f}) {
    for (const float second : {0.0f, -0.0f}) {
      EXPECT_EQ(verdict({ray({1, 0, -4}, {first, 0, 1}), ray({-1, 0, -4}, {second, 0, 1})}, kUnit, true),
                Verdict::kAll);
      EXPECT_EQ(verdict({ray({2, 0, -4}, {first, 0, 1}), ray({3, 0, -4}, {second, 0, 1})}, kUnit), Verdict::kMiss);
      EXPECT_EQ(verdict({ray({-2, 0, -4}, {first, 0, 1}), ray({-3, 0, -4}, {second, 0, 1})}, kUnit), Verdict::kMiss);
      EXPECT_EQ(verdict({ray({0, 0, -4}, {first, 0, 1}), ray({3, 0, -4}, {second, 0, 1})}, kUnit), Verdict::kUndecided);
    }
    // With others that are not zero: on the plane, leaving or not.
    EXPECT_EQ(verdict({ray({1, 0, -4}, {first, 0, 1}), ray({1, 0, -4}, {-0.1f, 0, 1})}, kUnit), Verdict::kAll);
    EXPECT_EQ(verdict({ray({1, 0, -4}, {first, 0, 1}), ray({1, 0, -4}, {0.1f, 0, 1})}, kUnit), Verdict::kUndecided);
    EXPECT_EQ(verdict({ray({2, 0, -4}, {first, 0, 1}), ray({2, 0, -4}, {-0.1f, 0, 1})}, kUnit), Verdict::kMiss);
  }
}

TEST(BundleInterval, FlatAndPointBoxesAreHit) {
  const Aabb flat{{-1, -1, 0}, {1, 1, 0}}, point{{0, 0, 0}, {0, 0, 0}};
  // The depth at which it is entered and left differs from ray to ray.
  EXPECT_EQ(verdict({ray({0, 0, -4}, {0.1f, 0.1f, 1}), ray({0, 0, -5}, {0.1f, 0.1f, 2})}, flat, true), Verdict::kAll);
  EXPECT_EQ(verdict({ray({0, 0, -4}, {0, 0.1f, 1}), ray({0, 0, -4}, {0, 0.2f, 1})}, point), Verdict::kMiss);
  EXPECT_EQ(verdict({ray({0, 0, -4}, {0, 0, 1}), ray({0, 0, -5}, {0, 0, 2})}, point), Verdict::kAll);
}

TEST(BundleInterval, AnUnusedLaneIsNeverHit) {
  EXPECT_EQ(verdict({ray({0, 0, -4}, {0, 0, 1}), ray({1, 0, -4}, {0, -0.0f, 1})}, Aabb{}), Verdict::kMiss);
  EXPECT_EQ(verdict({ray({0, 0, -4}, {-1, 0, 1}), ray({1, 0, -4}, {1, -0.0f, -1})}, Aabb{}), Verdict::kMiss);
}

TEST(BundleInterval, GoesByTheLatestEndOfTheRays) {
  const Vec3 eye{0, 0, -4}, ahead{0, 0, 1};  // 3 away
  const float short_of = std::nextafter(3.0f, 0.0f);
  EXPECT_EQ(verdict({ray(eye, ahead, 3), ray(eye, ahead, 3)}, kUnit), Verdict::kAll);
  EXPECT_EQ(verdict({ray(eye, ahead, short_of), ray(eye, ahead, 1)}, kUnit), Verdict::kMiss);
  EXPECT_EQ(verdict({ray(eye, ahead, 1), ray(eye, ahead, 3)}, kUnit), Verdict::kAll);  // as far as the record knows
  const Ray nearer = ray(eye + Vec3{0, 0, 0.5f}, ahead, short_of);
  EXPECT_EQ(verdict({ray(eye, ahead, short_of), nearer}, kUnit), Verdict::kUndecided);
}

TEST(BundleInterval, StrictIsOfTheBoxThatIsNotWidened) {
  const Vec3 eye{0, 0, -4};
  BundlesConfig config;
  Accel accel;
  Node node;
  set_child(node, 0, kUnit);
  IntersectionCounts counts;
  const BundleRecord record = record_of({ray(eye, {0.333333f, 0, 1}), ray(eye, {0.3f, 0, 1})});
  // Enters at 3, having left at 2.9999997; widening is by 16 u.
  const BundleRecord hit_by_rounding = record_of({ray(eye, {0.33333337f, 0, 1}), ray(eye, {0.3f, 0, 1})});
  EXPECT_EQ(verdict(test_bundle(accel, node, 1, record, config, counts), 0), Verdict::kAll);
  EXPECT_EQ(verdict(test_bundle(accel, node, 1, hit_by_rounding, config, counts), 0), Verdict::kAll);
  config.strict = true;
  EXPECT_EQ(verdict(test_bundle(accel, node, 1, record, config, counts), 0), Verdict::kAll);
  EXPECT_EQ(verdict(test_bundle(accel, node, 1, hit_by_rounding, config, counts), 0), Verdict::kUndecided);
}

TEST(BundleInterval, StrictIsExactBeyondDoubles) {
  // x = 1 is reached a 2^-60 after y = 1 is left, which no double shows.
  const Aabb box{{1, -1, -1}, {2, 1, 1}};
  const auto verdict_from = [&](float x) {
    BundlesConfig config;
    config.strict = true;
    Accel accel;
    accel.accuracy.box = BoxLevel::kDouble;
    Node node;
    set_child(node, 0, box);
    IntersectionCounts counts;
    const Vec3 eye{x, 0, 0}, direction{1, 1, 0.125f};
    EXPECT_EQ(ExactBox(ray(eye, direction), box, kInfinity).hit(), x >= 0);
    const BundleRecord record = record_of({ray(eye, direction), ray(eye, direction)});
    return verdict(test_bundle(accel, node, 1, record, config, counts), 0);
  };
  EXPECT_EQ(verdict_from(-0x1p-60f), Verdict::kUndecided);
  EXPECT_EQ(verdict_from(0x1p-30f), Verdict::kAll);
}

TEST(BundleInterval, SlowRaysAreNotSaidToMissWhereTheirReciprocalOverflows) {
  const float tiny = std::numeric_limits<float>::denorm_min();
  EXPECT_NE(verdict({ray({0, 0, -4}, {tiny, 0, 1}), ray({0, 0, -4}, {2 * tiny, 0, 1})}, kUnit), Verdict::kMiss);
  for (const float sign : {1.0f, -1.0f}) {
    const Vec3 eye{-2 * sign, 0, 0};
    const std::vector<Ray> slow{ray(eye, {sign * tiny, 0, 0}), ray(eye, {2 * sign * tiny, 0, 0})};
    BundlesConfig config;
    for (const BoxLevel level : {BoxLevel::kPlain, BoxLevel::kConservative}) {
      Accel accel;
      accel.accuracy.box = level;
      Node node;
      set_child(node, 0, kUnit);
      IntersectionCounts counts;
      EXPECT_NE(verdict(test_bundle(accel, node, 1, record_of(slow), config, counts), 0), Verdict::kMiss);
    }
  }
}

TEST(BundleInterval, EntryIsBeforeEveryRays) {
  Accel accel;
  Node node;
  set_child(node, 0, kUnit);
  IntersectionCounts counts;
  const auto entry = [&](const std::vector<Ray>& rays) {
    return test_bundle(accel, node, 1, record_of(rays), {}, counts).entry[0];
  };
  EXPECT_EQ(entry({ray({0, 0, -4}, {0, 0, 1}), ray({0, 0, -3}, {0, 0, 1})}), 2);
  EXPECT_EQ(entry({ray({0, 0, -4}, {0, 0, 1}), ray({0, 0, 0}, {0, 0, 1})}), 0);
  EXPECT_EQ(entry({ray({0, 0, -4}, {-0.1f, 0, 1}), ray({0, 0, -4}, {0.1f, 0, 2})}), 1.5f);
}

// Hit by all, missed by all, undecided, and a lane that is not asked for.
TEST(BundleInterval, OrdersDifferInWhatTheyTestAndInWhatTheyLeaveOpen) {
  Accel accel;
  Node node;
  set_child(node, 0, kUnit);
  set_child(node, 1, {{5, 5, 5}, {6, 6, 6}});
  set_child(node, 2, {{0.6f, -1, -1}, {1, 1, 1}});
  set_child(node, 3, kUnit);
  const BundleRecord record = record_of({ray({0, 0, -4}, {0.1f, 0, 1}), ray({0, 0, -4}, {0.2f, 0, 1})});
  struct Expected {
    Order order;
    std::uint8_t all, undecided;
    std::uint64_t tests;
  };
  for (const Expected& e : {Expected{Order::kAllHitFirst, 0b001, 0b100, 5},
                            {Order::kAnyHitFirst, 0b001, 0b100, 5},
                            {Order::kParallel, 0b001, 0b100, 6},
                            {Order::kAllHitOnly, 0b001, 0b110, 3},
                            {Order::kAnyHitOnly, 0b101, 0, 3}}) {
    BundlesConfig config;
    config.order = e.order;
    IntersectionCounts counts;
    const BundleAnswer answer = test_bundle(accel, node, 0b111, record, config, counts);
    EXPECT_EQ(answer.all, e.all) << enum_name(e.order);
    EXPECT_EQ(answer.undecided, e.undecided) << enum_name(e.order);
    EXPECT_EQ(counts.bundle, e.tests) << enum_name(e.order);
    EXPECT_EQ(answer.entry[0], 3) << enum_name(e.order);
    IntersectionCounts all_lanes;  // lanes beyond the node's children are nobody's
    EXPECT_EQ(test_bundle(accel, node, ~0u, record, config, all_lanes).all, e.all | 0b1000);
  }
}

// A bundle of one is told what the ray is told, to the bit.
TEST(BundleInterval, OneRayGetsTheAnswerOfItsOwnTest) {
  SCOPED_TRACE("CAROUSEL_SEED=" + std::to_string(run_seed()));
  Random random(1000 * std::uint64_t{run_seed()} + 86);
  const int cases = adversarial_cases() / 4;
  int hits = 0;
  for (int i = 0; i < cases; ++i) {
    const bool wild = i % 4 == 0;
    BoxCase c = box_case(random, wild ? 100 : 20, wild ? 140 : 10);
    c.ray.tmax = random.below(4) ? kInfinity : c.tmax;
    if (!valid(c.ray)) continue;
    const BundleRecord record = record_of({c.ray});
    for (const auto& level : kEnumNames<BoxLevel>) {
      const BoxAnswer single = box_answer(level.value, c.ray, c.box, c.ray.tmax);
      const auto expect_same = [&](const auto& interval, const auto& box) {
        ASSERT_EQ(interval.all_hit(box), single.hit) << i << " " << level.name;
        ASSERT_EQ(interval.all_miss(box), !single.hit) << i << " " << level.name;
        if (single.hit) {
          ASSERT_EQ(round_up(interval.entry(box)), single.entry) << i << " " << level.name;
        }
      };
      if (level.value == BoxLevel::kDouble) {
        expect_same(BundleInterval<double>(record, kFarWidening), planes_of<double>(c.box));
      } else {
        expect_same(BundleInterval<float>(record, far_widening(level.value)), planes_of<float>(c.box));
      }
      hits += single.hit;
    }
  }
  std::cout << cases << " cases, " << hits << " hits\n";
  EXPECT_GT(hits, cases / 4);
}

struct Share {
  double settled, alike;
};

/// The share of boxes that the tests of bundles of 32 rays with a common origin settle, and of those that all their
/// rays hit or all miss. `spread` is of directions, either way, in half-sizes of the box as seen from there; bundles
/// aim at the box and around it.
Share share_settled(float spread, const BundlesConfig& config) {
  Random random(1000 * std::uint64_t{run_seed()} + 87);
  constexpr int kBundles = 20000;
  int decided = 0, alike = 0;
  for (int i = 0; i < kBundles; ++i) {
    const Vec3 half = random.in_box(Vec3{0.5f}, Vec3{1});
    const Aabb box{-half, half};
    const float distance = random.uniform(5, 50), slack = spread / distance;
    const Vec3 eye = distance * Vec3(random_direction(random));
    const Vec3 ahead = glm::normalize(random.in_box(-2.0f * half, 2.0f * half) - eye);
    std::vector<Ray> rays;
    int hits = 0;
    for (int k = 0; k < 32; ++k) {
      rays.push_back(ray(eye, ahead + random.in_box(Vec3{-slack}, Vec3{slack})));
      hits += box_answer(BoxLevel::kConservative, rays.back(), box).hit;
    }
    alike += hits == 0 || hits == 32;
    Node node;
    set_child(node, 0, box);
    IntersectionCounts counts;
    decided += test_bundle(Accel{}, node, 1, record_of(rays), config, counts).undecided == 0;
  }
  return {double(decided) / kBundles, double(alike) / kBundles};
}

TEST(BundleInterval, SettlesMostBoxesOfNarrowBundles) {
  SCOPED_TRACE("CAROUSEL_SEED=" + std::to_string(run_seed()));
  for (const bool strict : {false, true}) {
    BundlesConfig config;
    config.strict = strict;
    for (const float spread : {0.01f, 0.03f, 0.1f, 0.2f, 0.5f}) {
      const Share share = share_settled(spread, config);
      std::cout << "spread " << spread << (strict ? ", strict: " : ": ") << share.settled << " settled of "
                << share.alike << "\n";
      EXPECT_LE(share.settled, share.alike);
      if (spread <= 0.03f) {
        EXPECT_GT(share.settled, 0.85) << spread;
      }
    }
  }
}

}  // namespace
}  // namespace carousel::accel
