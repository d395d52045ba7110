#pragma once

#include <cstdint>

#include "core/config/fields/memory.h"
#include "core/costs/costs.h"
#include "core/types/unit_kind.h"
#include "ringbus/cycle/builder/builder_unit.h"

namespace carousel::app {

/// The energy of a unit with the port of a builder, in J: it moved lines, and made so many tests. Its store of so many
/// KiB holds the lines, and `record_bytes` more.
double unit_joules(const Costs& costs, const MemoryConfig& memory, const ringbus::cycle::BuilderUse& use,
                   double store_kib, std::uint64_t record_bytes, std::uint64_t tests, UnitKind kind);

}  // namespace carousel::app
