#pragma once

#include <optional>

#include "core/config/config.h"
#include "core/costs/costs.h"
#include "core/costs/operations.h"

namespace carousel {

/// The method and the arithmetic of the tests of a kind of unit, at the levels of accuracy.
struct TestMethod {
  Method method;
  Arithmetic arithmetic;
};

/// None for kinds that no method of the table describes.
inline std::optional<TestMethod> test_method(const AccuracyConfig& c, UnitKind kind) {
  const bool fused = c.products == AccuracyConfig::Products::kFused;
  switch (kind) {
    case UnitKind::kBox:
      return TestMethod{Method::kSlab, {c.box == BoxLevel::kDouble, fused}};
    case UnitKind::kTriangle:
      return TestMethod{c.triangle == TriangleLevel::kFast    ? Method::kMollerTrumbore
                        : c.triangle == TriangleLevel::kExact ? Method::kFilteredTriangle
                                                              : Method::kWatertight,
                        {c.triangle == TriangleLevel::kDouble || c.triangle == TriangleLevel::kExact, fused}};
    case UnitKind::kProcedural:  // as a triangle of the default level
      return TestMethod{Method::kWatertight, {false, fused}};
    case UnitKind::kPlane:
      return TestMethod{Method::kPlane, {false, fused}};
    case UnitKind::kBundle:
      return TestMethod{Method::kIntervals, {false, fused}};
    case UnitKind::kTransform:
      return TestMethod{c.transform == TransformLevel::kInverseMatrix ? Method::kInverseMatrix : Method::kTwoStep,
                        {c.transform == TransformLevel::kTwoStepDouble, fused}};
    case UnitKind::kReciprocal:
      return TestMethod{Method::kDivision, {false, fused}};
    default:
      return std::nullopt;
  }
}

/// The area of a unit for this method. One for watertight triangles tests in 32 bits, and in 64 those that a ray meets.
inline double method_area_mm2(const AccuracyConfig& c, UnitKind kind, TestMethod of) {
  of.arithmetic.wide |= kind == UnitKind::kTriangle && c.triangle == TriangleLevel::kWatertight;
  return area_mm2(of.method, of.arithmetic);
}

namespace cost_detail {

inline CostValue profile_value(const Config& config, Cost cost) {
  const CostRow& row = kCostTable[cost_index(cost)];
  switch (config.energy.profile) {
    case CostProfile::kN45:
      return row.n45;
    case CostProfile::kN7:
      return row.n7;
    case CostProfile::kNone:
      break;
  }
  return {0, Basis::kAssumed, ""};
}

inline constexpr std::string_view kByOperations = "the number of the default method, by the operations of this one";

/// The profile's joules of a test, or area of a unit, by the method and the arithmetic of this machine.
inline CostValue method_value(const Config& config, UnitKind kind, bool energy) {
  const CostValue value = profile_value(config, energy ? energy_of(kind) : area_of(kind));
  const std::optional<TestMethod> own = test_method(config.accuracy, kind), usual = test_method({}, kind);
  if (!own) return value;
  const OperationPrices& each = config.energy.profile == CostProfile::kN7 ? kPicojoules7 : kPicojoules45;
  const double ratio = energy ? energy_of(own->method, each, own->arithmetic) / energy_of(usual->method, each)
                              : method_area_mm2(config.accuracy, kind, *own) / method_area_mm2({}, kind, *usual);
  if (ratio == 1) return value;
  return {static_cast<float>(ratio * static_cast<double>(value.value)), value.basis, kByOperations};
}

/// The configuration's own number of a part of the area, or the profile's.
inline float own_or_profile(const Config& config, Cost cost) {
  return config.area.own[cost_index(cost)].value_or(profile_value(config, cost).value);
}

}  // namespace cost_detail

/// The area of a unit that tests bundles by silhouettes (mm2), from the configuration's or the profile's numbers of its
/// parts.
inline float silhouette_unit_mm2(const Config& config) {
  constexpr float kEdgesAtOnce = 6;  // a box seen at a corner has six
  const float edges = config.bundles.edges == BundlesConfig::Edges::kParallel ? kEdgesAtOnce : 1;
  return cost_detail::own_or_profile(config, Cost::kSilhouetteUnit) +
         edges * cost_detail::own_or_profile(config, Cost::kEdgeUnit);
}

/// The number of a row for this machine: the configuration's own, or the profile's. Without a profile the number is
/// zero. Where spheres stand in place of boxes or planes, the numbers are those of primitives that are spheres; a ray
/// that meets an oriented box is first brought into its frame, as into an instance's.
inline CostValue cost_value(const Config& config, Cost cost) {
  const bool energy = kCostTable[cost_index(cost)].section == "energy";
  const OwnCosts& own = energy ? config.energy.own : config.area.own;
  if (own[cost_index(cost)]) return {*own[cost_index(cost)], Basis::kPublished, "the configuration"};
  const auto row = [&](UnitKind kind) { return energy ? energy_of(kind) : area_of(kind); };
  const auto value_of = [&](UnitKind kind) { return cost_detail::method_value(config, kind, energy).value; };
  CostValue value = cost_detail::profile_value(config, cost);
  for (const UnitKindRow& unit : kUnitKinds)
    if (row(unit.kind) == cost) value = cost_detail::method_value(config, unit.kind, energy);
  const bool box = cost == row(UnitKind::kBox), plane = cost == row(UnitKind::kPlane);
  using Elements = BvhConfig::Elements;
  if ((box && config.bvh.elements == Elements::kSpheres) ||
      (plane && config.cull_planes.object == CullPlanesConfig::Object::kSphere))
    return {value_of(UnitKind::kProcedural), Basis::kAssumed, "a sphere, as a procedural primitive"};
  if (box && config.bvh.elements == Elements::kOrientedBoxes)
    return {value.value + value_of(UnitKind::kTransform), Basis::kAssumed, "a box and a transform: boxes are oriented"};
  if (cost == row(UnitKind::kBundle) && !energy && config.bundles.form == BundlesConfig::Form::kSilhouette)
    return {silhouette_unit_mm2(config), Basis::kAssumed,
            "area.silhouette and area.edge: bundles are tested by silhouettes"};
  return value;
}

inline double cost(const Config& config, Cost cost) {
  return static_cast<double>(cost_value(config, cost).value);
}

/// Picojoules of work that a unit does beside its tests, by what a test of its kind costs this machine.
inline double work_pj(const Config& config, UnitKind kind, Method method, bool wide) {
  const OperationPrices& each = config.energy.profile == CostProfile::kN7 ? kPicojoules7 : kPicojoules45;
  const TestMethod test = *test_method(config.accuracy, kind);
  return cost(config, energy_of(kind)) * energy_of(method, each, {wide, test.arithmetic.fused}) /
         energy_of(test.method, each, test.arithmetic);
}

/// All numbers of this machine.
inline Costs costs_of(const Config& config) {
  Costs out;
  for (const CostRow& row : kCostTable) out.values[cost_index(row.cost)] = cost(config, row.cost);
  return out;
}

}  // namespace carousel
