#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/types/unit_kind.h"
#include "ringbus/cycle/fabric/port_counters.h"
#include "ringbus/cycle/testers/tester.h"

namespace carousel::ringbus::cycle {

/// The counters of a resource in its time series: one a kind of unit, these, and then two a port.
enum class ResourceCounter : std::uint8_t {
  kRayReads,        ///< busy cycles of the ray store's port
  kPrimitiveReads,  ///< busy cycles of its banks' port to the units for primitives
  kDispatch,        ///< busy cycles of the dispatch stage
  kIds,             ///< ray IDs in collections, times cycles
  kCollections,     ///< open collections, times cycles
  kPackets,         ///< packets of its own under way, times cycles
  kCompleted,       ///< rays
  kTested,          ///< rays
  kHeld,            ///< rays that have travelled here, in slots, times cycles
  kEnd,
};
constexpr std::size_t counter_index(ResourceCounter counter) {
  return kUnitKinds.size() + static_cast<std::size_t>(counter);
}
inline constexpr std::size_t kFirstPortCounter = counter_index(ResourceCounter::kEnd);

/// Fills in those of the units and of the ray store.
inline void read_units(Tester& tester, Cycle at, std::span<std::uint64_t> row) {
  const PerUnit<Cycle> busy = tester.busy_before(at);
  for (const auto [kind, cycles] : busy) row[unit_index(kind)] = cycles;
  row[counter_index(ResourceCounter::kRayReads)] = tester.reads_before(at);
  row[counter_index(ResourceCounter::kPrimitiveReads)] = tester.primitive_reads_before(at);
}

}  // namespace carousel::ringbus::cycle
