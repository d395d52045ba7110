#pragma once

#include "ringbus/cycle/wiring/simulated_machine.h"
#include "ringbus/results/energy_events.h"

namespace carousel::ringbus::cycle {

/// What has cost energy so far, while no agent runs. `events` keeps its storage from one call to the next.
void read_energy(const SimulatedMachine& machine, EnergyEvents& events);

}  // namespace carousel::ringbus::cycle
