// The exact level through a whole structure: the rounded boxes around a triangle take nothing from it.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "accel/certificate/triangle_oracle.h"
#include "core/config/config.h"
#include "core/types/enum_names.h"
#include "tests/accel/exact/adversarial_cases.h"
#include "tests/accel/primitive/adversarial_triangles.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

Accel exact_level(const scene::Scene& scene, BoxLevel box) {
  AccuracyConfig accuracy;
  accuracy.triangle = TriangleLevel::kExact;
  accuracy.box = box;
  return build_sequential(scene, 8, 4, accuracy);
}

constexpr float kLargest = std::numeric_limits<float>::max();

bool in_range(const TriangleOracle& oracle) {
  return oracle.hit() && oracle.compare_t(0) >= 0 && oracle.compare_t(kLargest) <= 0;
}

// Outside of [0, largest float] by so little that the nearest float is its end: the boxes decide, and either answer is
// right.
bool at_an_end(const TriangleOracle& oracle) {
  return oracle.hit() && ((oracle.compare_t(0) < 0 && oracle.t_is_nearest(0.0f)) ||
                          (oracle.compare_t(kLargest) > 0 && oracle.t_is_nearest(kLargest)));
}

TEST(ExactLevel, LosesAndInventsNothingInRoundedBoxes) {
  Random random(1000 * std::uint64_t{run_seed()} + 66);
  const int cases = adversarial_cases() / 20;
  int hits = 0, wrong = 0;
  for (int i = 0; i < cases; ++i) {
    const auto kind = static_cast<TriangleCaseKind>(i % kTriangleCaseKinds);
    if (kind == TriangleCaseKind::kScaledGrid || kind == TriangleCaseKind::kWildExponents) continue;  // the next test's
    TriangleCase c = triangle_case(kind, random);
    if (c.ray.direction == Vec3{0}) continue;
    const TriangleOracle oracle(c.ray, c.corners);
    if (at_an_end(oracle)) continue;
    const bool exact = in_range(oracle);
    const scene::Scene scene = scene_of(soup({c.corners[0], c.corners[1], c.corners[2]}));
    for (const BoxLevel box : {BoxLevel::kConservative, BoxLevel::kDouble}) {
      const Hit hit = trace_one(exact_level(scene, box), RayRequest{c.ray, {}});
      hits += hit.valid();
      if (hit.valid() != exact && ++wrong <= 3)
        ADD_FAILURE() << enum_name(box) << " " << text(c) << (exact ? "lost" : "invented");
    }
  }
  EXPECT_EQ(wrong, 0) << "CAROUSEL_SEED=" << run_seed();
  EXPECT_GT(hits, cases / 10);
}

TEST(ExactLevel, LosesAndInventsNothingAtAnyExponentInDoubleBoxes) {
  Random random(1000 * std::uint64_t{run_seed()} + 67);
  const int cases = adversarial_cases() / 40;
  int hits = 0, wrong = 0;
  for (int i = 0; i < cases; ++i) {
    const TriangleCase c =
        triangle_case(i % 2 ? TriangleCaseKind::kScaledGrid : TriangleCaseKind::kWildExponents, random);
    if (c.ray.direction == Vec3{0} || !std::isfinite(c.ray.direction.x + c.ray.direction.y + c.ray.direction.z))
      continue;
    const TriangleOracle oracle(c.ray, c.corners);
    if (at_an_end(oracle)) continue;
    const bool exact = in_range(oracle);
    const scene::Scene scene = scene_of(soup({c.corners[0], c.corners[1], c.corners[2]}));
    const Hit hit = trace_one(exact_level(scene, BoxLevel::kDouble), RayRequest{c.ray, {}});
    hits += hit.valid();
    if (hit.valid() != exact && ++wrong <= 3) ADD_FAILURE() << text(c) << (exact ? "lost" : "invented");
  }
  EXPECT_EQ(wrong, 0) << "CAROUSEL_SEED=" << run_seed();
  EXPECT_GT(hits, cases / 10);
}

}  // namespace
}  // namespace carousel::accel
