#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace carousel {

// The operations of each method of testing, counted in the kernels that the rows name. Joules, areas and passes through
// units are derived from this one table: the costs of core/costs/cost_table.h, the levels of core/config/costs.h, the
// passes of accel/transform/instance_data.h and ringbus/cycle/testers/unit_passes.h, and what `carousel accuracy` says.

/// Operations on numbers of 32 bits, or as many on numbers of 64.
struct Operations {
  int products = 0, sums = 0, comparisons = 0, divisions = 0;
  int fused = 0;  ///< those of the sums that a fused unit makes with a product before them, by accuracy.products
  int steps = 0;  ///< operations that wait for one another; 0: not counted
};

enum class Method : std::uint8_t {
  kSlab,
  kMollerTrumbore,
  kWatertight,
  kFilteredTriangle,
  kExactVolume,
  kPlane,
  kIntervals,
  kSilhouette,
  kEdge,
  kInverseMatrix,
  kTwoStep,
  kInversion,
  kFullInversion,
  kDivision,
  kWideDivision,
};

struct MethodRow {
  Method method;
  std::string_view name;  ///< with an article
  Operations operations;
  std::string_view where;  ///< the kernel, or the source
};

/// A fused sum is rounded once instead of twice. It is not used where two products are subtracted, whose errors must be
/// equal on both sides of an edge, nor where a sum comes first: the box test is monotone in a plane only as (p - o) d.
inline constexpr auto kMethods = std::to_array<MethodRow>({
    {Method::kSlab, "a box by its slabs", {6, 6, 10, 0, 0, 6}, "accel/box/slab-inl.h"},
    {Method::kMollerTrumbore, "a triangle, fast", {27, 24, 5, 1, 8}, "accel/primitive/moller_trumbore-inl.h"},
    {Method::kWatertight, "a triangle, watertight", {21, 22, 9, 1, 8}, "accel/primitive/watertight-inl.h"},
    {Method::kFilteredTriangle, "a triangle, exact", {21, 22, 9, 0, 8}, "accel/exact/crossing_filter.cpp"},
    {Method::kExactVolume, "an exact volume", {168, 168, 0, 0, 0}, "accel/exact/exact_triangle.cpp"},
    {Method::kPlane, "a cull plane", {6, 6, 3, 1, 5}, "accel/planes/cull_lanes-inl.h"},
    {Method::kIntervals, "a bundle by intervals", {6, 6, 10, 0, 0, 6}, "accel/box/bundle_interval.h"},
    {Method::kSilhouette, "a silhouette", {3, 6, 6, 0, 0, 4}, "accel/box/bundle_silhouette.cpp"},
    {Method::kEdge, "an edge", {2, 0, 1, 0, 0}, "accel/box/bundle_silhouette.cpp"},
    {Method::kInverseMatrix, "a transform, one matrix", {18, 15, 0, 0, 15}, "accel/transform/transform.h"},
    {Method::kTwoStep, "a transform, two steps", {18, 15, 0, 0, 12}, "accel/transform/two_step.h"},
    {Method::kInversion, "an inversion", {30, 11, 0, 1, 2}, "US 12394134, paragraph 25"},
    {Method::kFullInversion, "an inversion of the whole", {39, 17, 0, 1, 8}, "US 12394134, paragraph 25"},
    {Method::kDivision, "a division", {4, 4, 0, 0, 4}, "two steps of Newton"},
    {Method::kWideDivision, "a division in 64 bits", {6, 6, 0, 0, 6}, "three steps of Newton"},
});

constexpr const MethodRow& method_row(Method method) {
  return kMethods[static_cast<std::size_t>(method)];
}

static_assert([] {
  for (std::size_t i = 0; i < kMethods.size(); ++i)
    if (static_cast<std::size_t>(kMethods[i].method) != i) return false;
  return true;
}());

/// The numbers that a unit works with.
struct Arithmetic {
  bool wide = false;   ///< 64 bits
  bool fused = false;  ///< sums are fused with products where their method allows it
};

/// What one operation costs in 32 bits: joules, or an area, in any unit.
struct OperationPrices {
  double product, sum, comparison;
};

/// Picojoules. A comparison is a sum of integers. 45 nm: Horowitz, ISSCC 2014; 7 nm: Jouppi et al., ISCA 2021, Table 2.
inline constexpr OperationPrices kPicojoules45{3.7, 0.9, 0.1}, kPicojoules7{1.31, 0.4, 0.03};
/// Square millimetres at 45 nm, without registers and wires: Dally, tutorial of NIPS 2015.
inline constexpr OperationPrices kUnitMm2{7700e-6, 4184e-6, 137e-6};

/// Passes of a test in 64 bits through a unit built for 32 bits: a product of two 53-bit significands is four products
/// of 27 bits.
inline constexpr std::int64_t kDoublePasses = 4;
/// The sources have no numbers for 64 bits. A multiplier grows with the square of the significand's width, an adder in
/// proportion, and a comparison with the number.
inline constexpr double kWiderProduct = (27.0 / 24) * (27.0 / 24), kWiderSum = 53.0 / 24, kWiderComparison = 2;
/// The part of a sum's price that is left where it is fused: the rounding and the normalisation of the product go. No
/// source was found.
inline constexpr double kFusedSum = 0.5;

namespace operation_detail {

constexpr double price(const Operations& o, const OperationPrices& each, Arithmetic a, double passes) {
  double out = o.products * each.product * (a.wide ? passes * kWiderProduct : 1) +
               (o.sums - (a.fused ? (1 - kFusedSum) * o.fused : 0)) * each.sum * (a.wide ? kWiderSum : 1) +
               o.comparisons * each.comparison * (a.wide ? kWiderComparison : 1);
  if (o.divisions > 0)
    out +=
        o.divisions * price(method_row(a.wide ? Method::kWideDivision : Method::kDivision).operations, each, a, passes);
  return out;
}

}  // namespace operation_detail

/// Joules of a method, in the unit of `each`.
constexpr double energy_of(Method method, const OperationPrices& each, Arithmetic arithmetic = {}) {
  return operation_detail::price(method_row(method).operations, each, arithmetic, static_cast<double>(kDoublePasses));
}
/// The area of a unit that starts a test a cycle, or in 64 bits a test in four.
constexpr double area_mm2(Method method, Arithmetic arithmetic = {}) {
  return operation_detail::price(method_row(method).operations, kUnitMm2, arithmetic, 1);
}
/// Passes of a method's products through the multipliers of a unit for another one.
constexpr std::uint64_t passes_through(Method unit, Method method) {
  const int products = method_row(method).operations.products, each = method_row(unit).operations.products;
  return static_cast<std::uint64_t>((products + each - 1) / each);
}

}  // namespace carousel
