#pragma once

#include <algorithm>
#include <cstdint>

#include "accel/transform/instance_data.h"
#include "core/types/unit_kind.h"
#include "ringbus/cycle/testers/level_cycles.h"

namespace carousel::ringbus::cycle {

/// Passes through the units of a kind that `counts` need: one for each test. Inverting a matrix takes passes through
/// the transform units, an exact volume through the triangle units.
inline std::uint64_t passes_of(UnitKind kind, const IntersectionCounts& counts) {
  const std::uint64_t tests = counts.*unit_row(kind).tests;
  if (kind == UnitKind::kTriangle) return tests + kExactVolumeTests * counts.exact_volumes;
  return kind == UnitKind::kTransform ? tests + accel::kInversionPasses * counts.inversions : tests;
}

/// The tests of a single ray at one strip, in little room: a strip has few shapes.
struct RayTests {
  PerUnit<std::uint8_t> tests;  ///< by the kind of unit that makes them
  std::uint8_t inversions : 1 = 0;
  std::uint8_t exact_volumes : 7 = 0;
  friend bool operator==(const RayTests&, const RayTests&) = default;
};
inline RayTests ray_tests(const IntersectionCounts& counts) {
  RayTests out;
  for (const UnitKindRow& row : kUnitKinds) out.tests[row.kind] = static_cast<std::uint8_t>(counts.*row.tests);
  out.inversions = counts.inversions > 0;
  out.exact_volumes = static_cast<std::uint8_t>(std::min<std::uint64_t>(counts.exact_volumes, 127) & 127);
  return out;
}

}  // namespace carousel::ringbus::cycle
