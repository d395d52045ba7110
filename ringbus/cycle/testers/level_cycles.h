#pragma once

#include "core/config/config.h"
#include "ringbus/cycle/testers/unit_passes.h"

namespace carousel::ringbus::cycle {

/// Tests in 64 bits whose time an exact volume takes in the triangle unit. The volume of three differences of floats,
/// each a double and a rest, is 3 x (8 + 16) products of two doubles with their rounding errors for a side, and
/// 3 x (8 + 32) for the depth, whose third factor has a rest as well: 84 in the mean of the four, two products of 64
/// bits each (accel/exact/exact_triangle.cpp). A double test has 21.
inline constexpr std::uint64_t kExactVolumeTests = 8;

/// Testers that are configured for 32 bits, at the levels of `accuracy`. All tests in 32 bits cost the same:
/// Möller-Trumbore has 27 products a triangle, the watertight test 21, and a conservative box adds three products a
/// ray. An exact test is charged as its filter in 64 bits, and for the arithmetic behind the filter as above.
inline TestersConfig at_levels(TestersConfig testers, const AccuracyConfig& accuracy) {
  if (accuracy.triangle == TriangleLevel::kDouble || accuracy.triangle == TriangleLevel::kExact)
    testers.units[UnitKind::kTriangle].interval_cycles *= kDoublePasses;
  if (accuracy.box == BoxLevel::kDouble) testers.units[UnitKind::kBox].interval_cycles *= kDoublePasses;
  if (accuracy.transform == TransformLevel::kTwoStepDouble)
    testers.units[UnitKind::kTransform].interval_cycles *= kDoublePasses;
  return testers;
}

}  // namespace carousel::ringbus::cycle
