#pragma once

#include "core/config/config.h"
#include "core/config/key_conditions.h"
#include "report/run/report.h"

namespace carousel::app {

/// Adds the sections energy, area and costs, from the counters that the report of a simulated machine has already.
/// Nothing without energy.profile.
void add_energy(report::Report& r, const Config& config, const SceneFacts& scene);

}  // namespace carousel::app
