#pragma once

#include <cstdint>

#include "accel/transform/instance_data.h"
#include "core/costs/operations.h"
#include "core/types/unit_kind.h"

namespace carousel::ringbus::cycle {

/// Tests in 64 bits whose time an exact volume takes in the triangle unit. The volume of three differences of floats,
/// each a double and a rest, is 3 x (8 + 16) products of two doubles with their rounding errors for a side, and
/// 3 x (8 + 32) for the depth, whose third factor has a rest as well: 84 in the mean of the four, two products of 64
/// bits each (accel/exact/exact_triangle.cpp). A double test has 21.
inline constexpr std::uint64_t kExactVolumeTests = passes_through(Method::kFilteredTriangle, Method::kExactVolume);

/// Passes through the units of a kind that the tests in `counts` need: one for each test. A triangle that a ray meets
/// in 32 bits is tested again in 64, for its distance, and exact volumes take their tests; a transform for a nearly
/// singular instance is in 64 bits. A program takes a pass a cycle of its own, and the unit takes the next test when it
/// is over.
inline std::uint64_t passes_of(UnitKind kind, const IntersectionCounts& counts) {
  const std::uint64_t tests = counts.*unit_row(kind).tests;
  if (kind == UnitKind::kTriangle)
    return tests + kDoublePasses * counts.refined + kExactVolumeTests * counts.exact_volumes;
  if (kind == UnitKind::kProcedural) return tests - counts.programs + counts.program_cycles;
  if (kind == UnitKind::kTransform) return tests + (kDoublePasses - 1) * counts.transforms_in_double;
  return tests;
}
/// Passes through the transform units ahead of that, for the inversions of an instance's matrix.
inline std::uint64_t inversion_passes(const IntersectionCounts& counts) {
  constexpr std::uint64_t more = accel::kFullInversionPasses - accel::kInversionPasses;
  return accel::kInversionPasses * (counts.inversions + (kDoublePasses - 1) * counts.inversions_in_double) +
         more * counts.full_inversions;
}

/// The passes that the tests of a single ray need at one strip. A strip has at most 128 triangles (eight leaves of 16
/// in a mixed node), of 33 passes each where all of their volumes are exact, and of 66 steps each of a buffer of 64
/// hits. Its programs have 2^31 passes at most.
struct RayTests {
  PerUnit<std::uint16_t> tests;      ///< by the kind of unit that makes them
  std::uint8_t inversion = 0;        ///< ahead of them, through the transform units
  std::uint32_t program_cycles = 0;  ///< of these tests, those that run programs: passes beside `tests`
  std::uint64_t passes(UnitKind kind) const {
    return tests[kind] + (kind == UnitKind::kProcedural ? std::uint64_t{program_cycles} : 0);
  }
  /// Of sums over all strips so far, as ray_tests() says them modulo the width of each number, those of the last ones.
  RayTests since(const RayTests& before) const {
    RayTests out;
    for (const auto [kind, passes] : tests) out.tests[kind] = static_cast<std::uint16_t>(passes - before.tests[kind]);
    out.inversion = static_cast<std::uint8_t>(inversion - before.inversion);
    out.program_cycles = program_cycles - before.program_cycles;
    return out;
  }
  friend bool operator==(const RayTests&, const RayTests&) = default;
};
inline RayTests ray_tests(const IntersectionCounts& counts) {
  RayTests out;
  for (const UnitKindRow& row : kUnitKinds)
    if (row.kind != UnitKind::kProcedural)
      out.tests[row.kind] = static_cast<std::uint16_t>(passes_of(row.kind, counts));
  out.tests[UnitKind::kProcedural] = static_cast<std::uint16_t>(counts.procedural - counts.programs);
  out.program_cycles = static_cast<std::uint32_t>(counts.program_cycles);
  out.inversion = static_cast<std::uint8_t>(inversion_passes(counts));
  return out;
}

}  // namespace carousel::ringbus::cycle
