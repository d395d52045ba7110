#pragma once

#include "core/config/fields/accuracy.h"
#include "core/config/fields/testers.h"
#include "core/statistics/intersection_counts.h"

namespace carousel::app {

/// Area of the box, triangle and transform units of one resource at the levels of `accuracy`, in mm^2 of a 45 nm
/// process: their multipliers, adders and comparators (core/costs/operations.h), without registers, wires and control.
double unit_area_mm2(const TestersConfig& testers, const AccuracyConfig& accuracy);

/// Energy of the operations of `counts` at these levels, in pJ, likewise.
double test_energy_pj(const IntersectionCounts& counts, const AccuracyConfig& accuracy);

}  // namespace carousel::app
