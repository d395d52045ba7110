#pragma once

#include <cstdint>

#include "accel/transform/instance_data.h"
#include "core/types/unit_kind.h"

namespace carousel::ringbus::cycle {

/// Passes through the units of a kind that `counts` need: one for each test. Inverting a matrix takes passes through
/// the transform units.
inline std::uint64_t passes_of(UnitKind kind, const IntersectionCounts& counts) {
  const std::uint64_t tests = counts.*unit_row(kind).tests;
  return kind == UnitKind::kTransform ? tests + accel::kInversionPasses * counts.inversions : tests;
}

/// The tests of a single ray at one strip, in little room: a strip has few shapes.
struct RayTests {
  PerUnit<std::uint8_t> tests;  ///< by the kind of unit that makes them
  std::uint8_t inversions = 0;
  friend bool operator==(const RayTests&, const RayTests&) = default;
};
inline RayTests ray_tests(const IntersectionCounts& counts) {
  RayTests out;
  for (const UnitKindRow& row : kUnitKinds) out.tests[row.kind] = static_cast<std::uint8_t>(counts.*row.tests);
  out.inversions = static_cast<std::uint8_t>(counts.inversions);
  return out;
}

}  // namespace carousel::ringbus::cycle
