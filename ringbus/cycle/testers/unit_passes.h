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

}  // namespace carousel::ringbus::cycle
