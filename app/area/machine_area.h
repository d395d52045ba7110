#pragma once

#include "core/config/key_conditions.h"
#include "core/config/load/load.h"
#include "report/sections/costs.h"

namespace carousel::app {

/// The area of the machine by its parts, those that the scene puts to use, and the length of a link. Zero without
/// energy.profile.
report::Area machine_area(const Config& config, const SceneFacts& scene);

/// The stack registers of a resource with warps, in KiB: 12 bytes an entry.
double register_kib(const Config& config, std::int64_t resource);

/// The store of the builder (`frames.builder`) in KiB: records of primitives, and the lines that it waits for.
double builder_kib(const Config& config);

/// Holds the machine to area.budget_mm2: gives it the largest number of resources whose machine is within the budget,
/// or refuses it, as area.fit says. Throws a ConfigError where no number is.
void fit_area(LocatedConfig& located, const SceneFacts& scene);

}  // namespace carousel::app
