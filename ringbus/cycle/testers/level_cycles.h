#pragma once

#include "core/config/config.h"

namespace carousel::ringbus::cycle {

/// What a test in 64 bits takes of a unit built for 32: a product of two 53-bit significands is four of 27 bits, so
/// its multipliers are gone through four times. Everything in 32 bits costs the same: Möller-Trumbore has 27 products
/// a triangle, the watertight test 21, and what a conservative box adds is three products a ray. An exact test is
/// charged as its filter in 64 bits; what the filter leaves to longer arithmetic is not charged.
inline constexpr std::int64_t kDoublePasses = 4;

/// The testers as configured are built for 32 bits; as they are at the levels of `accuracy`.
inline TestersConfig at_levels(TestersConfig testers, const AccuracyConfig& accuracy) {
  if (accuracy.triangle == TriangleLevel::kDouble || accuracy.triangle == TriangleLevel::kExact)
    testers.units[UnitKind::kTriangle].interval_cycles *= kDoublePasses;
  if (accuracy.box == BoxLevel::kDouble) testers.units[UnitKind::kBox].interval_cycles *= kDoublePasses;
  if (accuracy.transform == TransformLevel::kTwoStepDouble)
    testers.units[UnitKind::kTransform].interval_cycles *= kDoublePasses;
  return testers;
}

}  // namespace carousel::ringbus::cycle
