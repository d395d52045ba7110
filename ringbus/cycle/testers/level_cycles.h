#pragma once

#include "core/config/fields/accuracy.h"
#include "core/config/fields/bundles.h"
#include "core/config/fields/testers.h"
#include "ringbus/cycle/testers/unit_passes.h"

namespace carousel::ringbus::cycle {

/// Testers that are configured for 32 bits and for tests of bundles by intervals, at the levels of `accuracy` and for
/// the form of `bundles`. All tests in 32 bits cost the same: Möller-Trumbore has 27 products a triangle, the
/// watertight test 21, and a conservative box adds three products a ray. An exact test is charged as its filter in 64
/// bits, and for the arithmetic behind the filter as above. A silhouette answers earlier, as fewer operations wait for
/// one another.
inline TestersConfig at_levels(TestersConfig testers, const AccuracyConfig& accuracy, const BundlesConfig& bundles) {
  if (accuracy.triangle == TriangleLevel::kDouble || accuracy.triangle == TriangleLevel::kExact)
    testers.units[UnitKind::kTriangle].interval_cycles *= kDoublePasses;
  if (accuracy.box == BoxLevel::kDouble) testers.units[UnitKind::kBox].interval_cycles *= kDoublePasses;
  if (accuracy.transform == TransformLevel::kTwoStepDouble)
    testers.units[UnitKind::kTransform].interval_cycles *= kDoublePasses;
  if (bundles.form == BundlesConfig::Form::kSilhouette) {
    constexpr std::int64_t own = method_row(Method::kSilhouette).operations.steps,
                           other = method_row(Method::kIntervals).operations.steps;
    std::int64_t& latency = testers.units[UnitKind::kBundle].latency_cycles;
    latency = (latency * own + other - 1) / other;
  }
  return testers;
}

}  // namespace carousel::ringbus::cycle
