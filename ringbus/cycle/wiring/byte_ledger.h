#pragma once

#include <vector>

#include "ringbus/cycle/wiring/simulated_machine.h"
#include "ringbus/results/byte_row.h"

namespace carousel::ringbus::cycle {

/// Every byte that a part of the machine has handed to another, by kind of message; after a run. Credits, one bit each
/// on a wire of their own, are not counted.
std::vector<ByteRow> byte_ledger(const SimulatedMachine& machine, const Config& config);

/// Throws a SimulationError that names the first kind of message of which senders have not counted as many bytes as
/// receivers and the wires between them.
void check_byte_ledger(const std::vector<ByteRow>& rows);

}  // namespace carousel::ringbus::cycle
