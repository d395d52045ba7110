#pragma once

#include <cstddef>

#include "core/config/fields/topology.h"
#include "ringbus/cycle/wiring/simulated_machine.h"
#include "ringbus/results/time_series.h"

namespace carousel::ringbus::cycle {

/// The most rows that the time series of a machine may have.
std::size_t series_counters(const TopologyConfig& config);

/// The readings of all agents of a machine, which is closed, as rows: those of the machine, of the resources and of the
/// links. Sums and means of integers over samples of 2^n cycles: with fewer than 2^53 they are exact.
TimeSeries machine_series(const SimulatedMachine& machine);

}  // namespace carousel::ringbus::cycle
