#pragma once

#include "core/config/config.h"
#include "core/costs/costs.h"

namespace carousel {

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
  const CostValue value = cost_detail::profile_value(config, cost);
  const auto row = [&](UnitKind kind) { return energy ? energy_of(kind) : area_of(kind); };
  const auto value_of = [&](UnitKind kind) { return cost_detail::profile_value(config, row(kind)).value; };
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

/// All numbers of this machine.
inline Costs costs_of(const Config& config) {
  Costs out;
  for (const CostRow& row : kCostTable) out.values[cost_index(row.cost)] = cost(config, row.cost);
  return out;
}

}  // namespace carousel
