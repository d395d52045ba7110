#pragma once

#include <cstdint>

#include "core/config/fields/memory.h"
#include "core/costs/costs.h"
#include "ringbus/cycle/builder/builder_unit.h"

namespace carousel::app {

/// The energy of a unit with the port of a builder, in J: it moved lines, and its tests took `tests_pj`. Its store of
/// so many KiB holds the lines, and `record_bytes` more.
double unit_joules(const Costs& costs, const MemoryConfig& memory, const ringbus::cycle::BuilderUse& use,
                   double store_kib, std::uint64_t record_bytes, double tests_pj);

}  // namespace carousel::app
