// Nothing that a bundle's tests claim is wrong of one of its rays: judged by the box test of each ray at the same
// level, and by big integers, over bundles and boxes made to be hard.
#include <array>
#include <cmath>
#include <iostream>
#include <string>

#include <gtest/gtest.h>

#include "accel/box/bundle_intersect.h"
#include "core/config/config.h"
#include "core/types/enum_names.h"
#include "tests/accel/box/box_levels.h"
#include "tests/accel/box/bundle_cases.h"
#include "tests/accel/box/exact_box_hit.h"
#include "tests/accel/exact/adversarial_cases.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

using Order = BundlesConfig::Order;

struct Claims {
  std::uint64_t bundles = 0, boxes = 0;
  std::uint64_t misses = 0, all = 0, undecided = 0;  // boxes
  std::uint64_t against_kernel = 0, against_exact = 0, late_entries = 0, undecided_rays = 0;
};

std::string description(const BundleCase& c, const Aabb& box, BoxLevel level, const BundlesConfig& config) {
  std::ostringstream out;
  out << enum_name(level) << " " << enum_name(config.form) << " " << enum_name(config.order)
      << (config.strict ? " strict" : "") << std::hexfloat << "\nbox";
  for (const Vec3& v : {box.lo, box.hi}) out << "  " << v.x << " " << v.y << " " << v.z;
  for (const Ray& r : c.rays)
    out << "\nray " << r.origin.x << " " << r.origin.y << " " << r.origin.z << "  " << r.direction.x << " "
        << r.direction.y << " " << r.direction.z << "  " << r.tmax;
  return out.str();
}

// Widening is of boxes: where a range ends just after the exact entry, every level may find that it ends before.
constexpr float kSurelyBefore = 1 - 0x1p-21f;

// True if exact arithmetic must agree with every miss of the level: widening makes it so if the distances are normal
// floats.
bool misses_are_exact(BoxLevel level, int pace) {
  return level == BoxLevel::kDouble || (level == BoxLevel::kConservative && pace <= 10);
}

Claims judge(BundlesConfig::Form form, std::uint64_t bundles, int reach, int pace, std::uint64_t number) {
  Random random(1000 * std::uint64_t{run_seed()} + number);
  Claims claims;
  int shown = 0;
  const auto wrong = [&](std::uint64_t& count, const char* what, const std::string& which) {
    ++count;
    if (++shown <= 3) ADD_FAILURE() << what << ": " << which;
  };
  Accel accel;
  for (; claims.bundles < bundles; ++claims.bundles) {
    const BundleCase c = bundle_case(random, reach, pace);
    BundleRecord record = record_of(c.rays);
    if (random.below(8) == 0) record.tmax = kInfinity;  // out of date
    BundlesConfig config;
    config.form = form;
    config.order = static_cast<Order>(random.below(5));
    config.strict = random.below(2) == 0;
    const BoxLevel level = accel.accuracy.box = static_cast<BoxLevel>(random.below(3));
    IntersectionCounts counts;
    const BundleAnswer answer = test_bundle(accel, c.node, ~0u, record, config, counts);
    EXPECT_EQ(answer.all & answer.undecided, 0);
    for (int lane = 0; lane < BundleCase::kBoxes; ++lane, ++claims.boxes) {
      const Aabb box = child_box(c.node, lane);
      const auto describe = [&] { return description(c, box, level, config); };
      const bool all = answer.all >> lane & 1, undecided = answer.undecided >> lane & 1;
      if (undecided) {
        ++claims.undecided;
        const bool both = config.order != Order::kAllHitOnly && !config.strict;
        if (both && c.rays.size() == 1) wrong(claims.undecided_rays, "one ray, undecided", describe());
      } else if (!all) {
        ++claims.misses;
        bool kernel = false, exact = false;
        for (const Ray& ray : c.rays) {
          kernel |= box_answer(level, ray, box, ray.tmax).hit;
          exact |= misses_are_exact(level, pace) && exactly_hits(ray, box, ray.tmax * kSurelyBefore);
        }
        if (kernel) wrong(claims.against_kernel, "a ray hits, all are said to miss", describe());
        if (exact) wrong(claims.against_exact, "a ray hits exactly, all are said to miss", describe());
      } else {
        ++claims.all;
        const bool any_hit_only = config.order == Order::kAnyHitOnly;  // claims nothing of all
        bool kernel = false, exact = false, late = false;
        for (const Ray& ray : c.rays) {
          const BoxAnswer single = box_answer(level, ray, box, record.tmax);
          kernel |= !any_hit_only && !single.hit;
          exact |= !any_hit_only && config.strict && !exactly_hits(ray, box, record.tmax);
          late |= single.hit && !(answer.entry[lane] <= single.entry);
        }
        if (kernel) wrong(claims.against_kernel, "a ray misses, all are said to hit", describe());
        if (exact) wrong(claims.against_exact, "a ray misses exactly, all are said to hit", describe());
        if (late) wrong(claims.late_entries, "a ray enters before the bundle", describe());
      }
    }
  }
  std::cout << claims.bundles << " cases: " << enum_name(form) << ", " << claims.boxes << " boxes, " << claims.misses
            << " missed by all, " << claims.all << " hit by all, " << claims.undecided << " undecided\n";
  return claims;
}

void expect_sound(BundlesConfig::Form form, std::uint64_t bundles, int reach, int pace, std::uint64_t number) {
  SCOPED_TRACE("CAROUSEL_SEED=" + std::to_string(run_seed()));
  const Claims claims = judge(form, bundles, reach, pace, number);
  EXPECT_EQ(claims.against_kernel, 0u);
  EXPECT_EQ(claims.against_exact, 0u);
  EXPECT_EQ(claims.late_entries, 0u);
  EXPECT_EQ(claims.undecided_rays, 0u);
  EXPECT_GT(claims.misses, claims.boxes / 10);  // or nothing was claimed
  EXPECT_GT(claims.all, claims.boxes / 10);
  EXPECT_GT(claims.undecided, claims.boxes / 20);
}

std::uint64_t bundles() {
  return static_cast<std::uint64_t>(adversarial_cases());
}

TEST(BundleOracle, IntervalsClaimNothingThatIsWrongOfARay) {
  expect_sound(BundlesConfig::Form::kInterval, bundles() / 2, 20, 10, 84);
}
TEST(BundleOracle, IntervalsOfAnyExponentClaimNothingThatIsWrongOfARay) {
  expect_sound(BundlesConfig::Form::kInterval, bundles() / 5, 83, 140, 85);
}
TEST(BundleOracle, SilhouettesClaimNothingThatIsWrongOfARay) {
  expect_sound(BundlesConfig::Form::kSilhouette, bundles() / 2, 20, 10, 88);
}
TEST(BundleOracle, SilhouettesOfAnyExponentClaimNothingThatIsWrongOfARay) {
  expect_sound(BundlesConfig::Form::kSilhouette, bundles() / 5, 83, 140, 89);
}

}  // namespace
}  // namespace carousel::accel
