// Energy of an operation: M. Horowitz, "Computing's energy problem (and what we can do about it)", ISSCC 2014,
// figure 1.1.9 (45 nm, 0.9 V): a product of floats 3.7 pJ, a sum 0.9 pJ. Their areas, synthesised for the same process,
// are those that W. Dally shows beside these energies ("High-performance hardware for machine learning", tutorial, NIPS
// 2015): 7,700 and 4,184 square micrometres. The source has no numbers for 64 bits; they follow from the widths of the
// significands: a multiplier's area and energy grow with the square, an adder's in proportion.
#include "app/accuracy/unit_cost.h"

namespace carousel::app {

namespace {

struct Operations {
  double products = 0, sums = 0;
};

// The operations of one test. A division counts as four products (a table and two steps of Newton's method), and
// comparisons count as nothing.
constexpr Operations kBox{6, 6}, kPlane{6 + 4, 6}, kTransform{18, 15};
constexpr Operations kFast{27 + 4, 23}, kWatertight{21 + 4, 22};
/// The operations of a volume in exact arithmetic: 84 products of doubles with their rounding errors
/// (ringbus/cycle/testers/unit_passes.h), each with about as many sums.
constexpr Operations kExactVolume{168, 168};

constexpr double kProductPj = 3.7, kSumPj = 0.9, kProductMm2 = 7700e-6, kSumMm2 = 4184e-6;

/// A test in 64 bits takes four passes through multipliers of 27 bits, and adders of 53 bits, instead of 24.
constexpr double kWiderProduct = (27.0 / 24) * (27.0 / 24), kWiderSum = 53.0 / 24, kPasses = 4;

double area(Operations o, bool wide) {
  return o.products * kProductMm2 * (wide ? kWiderProduct : 1) + o.sums * kSumMm2 * (wide ? kWiderSum : 1);
}
double energy(Operations o, bool wide) {
  return o.products * kProductPj * (wide ? kPasses * kWiderProduct : 1) + o.sums * kSumPj * (wide ? kWiderSum : 1);
}

struct Level {
  Operations triangle;
  bool wide_triangle, wide_box, wide_transform;
  bool refines = false;  ///< the unit makes tests in 32 bits, and again in 64 for what a ray meets
};
Level level_of(const AccuracyConfig& a) {
  return {a.triangle == TriangleLevel::kFast ? kFast : kWatertight,
          a.triangle == TriangleLevel::kDouble || a.triangle == TriangleLevel::kExact, a.box == BoxLevel::kDouble,
          a.transform == TransformLevel::kTwoStepDouble, a.triangle == TriangleLevel::kWatertight};
}

}  // namespace

double unit_area_mm2(const TestersConfig& testers, const AccuracyConfig& accuracy) {
  const Level level = level_of(accuracy);
  const auto units = [&](UnitKind kind) { return static_cast<double>(testers.units[kind].units); };
  return units(UnitKind::kBox) * area(kBox, level.wide_box) +
         units(UnitKind::kTriangle) * area(level.triangle, level.wide_triangle || level.refines) +
         units(UnitKind::kTransform) * area(kTransform, level.wide_transform);
}

double test_energy_pj(const IntersectionCounts& counts, const AccuracyConfig& accuracy) {
  const Level level = level_of(accuracy);
  return static_cast<double>(counts.box) * energy(kBox, level.wide_box) +
         static_cast<double>(counts.plane) * energy(kPlane, false) +
         static_cast<double>(counts.triangle) * energy(level.triangle, level.wide_triangle) +
         static_cast<double>(counts.exact_volumes) * energy(kExactVolume, true) +
         static_cast<double>(counts.refined) * energy(level.triangle, true) +
         static_cast<double>(counts.transforms - counts.transforms_in_double) *
             energy(kTransform, level.wide_transform) +
         static_cast<double>(counts.transforms_in_double) * energy(kTransform, true);
}

}  // namespace carousel::app
