#pragma once

#include <algorithm>
#include <cstdint>

#include "accel/transform/instance_data.h"
#include "core/types/unit_kind.h"
#include "ringbus/cycle/testers/level_cycles.h"

namespace carousel::ringbus::cycle {

/// Passes of a test in 64 bits through a unit built for 32 bits: a product of two 53-bit significands is four products
/// of 27 bits.
inline constexpr std::int64_t kDoublePasses = 4;

/// Passes through the units of a kind that the tests in `counts` need: one for each test. A triangle that a ray meets
/// in 32 bits is tested again in 64, for its distance, and exact volumes take their tests; a transform for a nearly
/// singular instance is in 64 bits.
inline std::uint64_t passes_of(UnitKind kind, const IntersectionCounts& counts) {
  const std::uint64_t tests = counts.*unit_row(kind).tests;
  if (kind == UnitKind::kTriangle)
    return tests + kDoublePasses * counts.refined + kExactVolumeTests * counts.exact_volumes;
  if (kind == UnitKind::kTransform) return tests + (kDoublePasses - 1) * counts.transforms_in_double;
  return tests;
}
/// Passes through the transform units ahead of that, for the inversions of an instance's matrix.
inline std::uint64_t inversion_passes(const IntersectionCounts& counts) {
  return accel::kInversionPasses * counts.inversions * (counts.transforms_in_double > 0 ? kDoublePasses : 1);
}

/// The passes that the tests of a single ray need at one strip, in little room: a strip has few shapes.
struct RayTests {
  PerUnit<std::uint8_t> tests;  ///< by the kind of unit that makes them
  std::uint8_t inversion = 0;   ///< ahead of them, through the transform units
  friend bool operator==(const RayTests&, const RayTests&) = default;
};
inline RayTests ray_tests(const IntersectionCounts& counts) {
  RayTests out;
  for (const UnitKindRow& row : kUnitKinds)  // hardly ever more than 255: some 30 volumes that doubles do not decide
    out.tests[row.kind] = static_cast<std::uint8_t>(std::min<std::uint64_t>(passes_of(row.kind, counts), 255));
  out.inversion = static_cast<std::uint8_t>(inversion_passes(counts));
  return out;
}

}  // namespace carousel::ringbus::cycle
