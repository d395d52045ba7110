#pragma once

#include <cstdint>
#include <optional>

#include "app/host/interrupt.h"
#include "app/run/prepare.h"
#include "report/versus/versus.h"

namespace carousel::app {

struct VersusSettings {
  std::uint64_t seeds = 3;
  bool search = true;  ///< relax each class of parts of the slower machine
  bool quiet = false;
  std::optional<AreaConfig::Aim> best{};  ///< the twin at equal area gets its best split (area.fit: best), by this
};

/// Simulates the machine of `prepared`, its conventional twin, and the twin at equal area, each with as many seeds of
/// the picture, from the configuration's on; then the slower of the first two with each class of its parts relaxed.
/// Throws a ConfigError where there is no twin, a SimulationError if hits or pictures differ, and Interrupted.
report::Versus run_versus(Prepared& prepared, const VersusSettings& settings, const InterruptScope& interrupt);

}  // namespace carousel::app
