#pragma once

#include <string>
#include <vector>

#include "report/sections/bottleneck.h"
#include "report/sections/engine.h"
#include "report/sections/shading.h"

namespace carousel::report {

/// The lines of a run's table about what limits the machine, each with its end.
std::string verdict_table(const Bottleneck& found);

/// The line about the interval of a run's cycles, with its end.
std::string noise_table(const CycleNoise& noise);

/// The names of what costs nothing, on lines of their own; none if everything is charged.
std::string charges_table(const std::vector<Charge>& charges);

/// The lines about the cycles that the choice of effects spared, each with its end.
std::string spared_table(const EffectsSpared& spared);

}  // namespace carousel::report
