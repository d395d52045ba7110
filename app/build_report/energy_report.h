#pragma once

#include "core/config/config.h"
#include "core/config/key_conditions.h"
#include "report/run/report.h"

namespace carousel::app {

/// Adds the sections energy, area and costs, from the counters that the report of a simulated machine has already.
/// Nothing without energy.profile.
void add_energy(report::Report& r, const Config& config, const SceneFacts& scene);

/// Adds the energy of a ray of the whole frame to the estimates of a sample: that of the sample, but with the estimated
/// bytes from and to the memory. Nothing without energy or estimates.
void add_sampled_energy(report::Report& r, const Config& config);

}  // namespace carousel::app
