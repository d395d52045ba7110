#pragma once

#include <vector>

#include "core/config/fields/memory.h"
#include "core/statistics/byte_row.h"
#include "ringbus/cycle/wiring/simulated_machine.h"

namespace carousel::ringbus::cycle {

/// Every byte that a part of the machine has handed to another, by kind of message; after a run: the counts of all
/// channels, and of the wires within a part. Credits, one bit each on a wire of their own, are not counted.
std::vector<ByteRow> byte_ledger(const SimulatedMachine& machine);

/// Throws a SimulationError that names the first kind of message of which senders have not counted as many bytes as
/// receivers and the wires between them.
void check_byte_ledger(const std::vector<ByteRow>& rows);

/// Throws a SimulationError unless the caches have looked up the lines that they sent, and these are the lines for
/// which resources, and ray control and shading, have asked. Holds for a run that was not stopped.
void check_lines(const SimulatedMachine& machine, const std::vector<ByteRow>& rows, const MemoryConfig& memory);

}  // namespace carousel::ringbus::cycle
