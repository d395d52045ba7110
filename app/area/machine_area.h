#pragma once

#include <optional>

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
/// That of the unit that rasterises first hits: lines on their way.
double raster_kib(const Config& config);

/// The machine with the most resources that is within area.budget_mm2. With `all`, shading.workers, where it is given,
/// grows by the same factor, and so do size and banks of an L2 that all resources share. None if no number of resources
/// makes such a machine.
std::optional<Config> largest_machine(const LocatedConfig& machine, const SceneFacts& scene, bool all);

/// Holds the machine to area.budget_mm2: gives it the largest number of resources whose machine is within the budget,
/// or refuses it, as area.fit says. With `best` it stays as it is, for a search to find the split. Throws a ConfigError
/// where no number is.
void fit_area(LocatedConfig& located, const SceneFacts& scene);

/// True if the split of the machine's area is searched for (area.fit: best).
inline bool is_searched(const AreaConfig& area) {
  return area.budget_mm2 && area.fit == AreaConfig::Fit::kBest;
}

/// Refuses area.fit: best where no search follows. Throws a ConfigError.
void require_no_search(const LocatedConfig& located);

}  // namespace carousel::app
