#pragma once

#include "app/host/interrupt.h"
#include "app/run/prepare.h"
#include "report/sections/costs.h"

namespace carousel::app {

/// Simulates at most 40 splits of `given`'s area.budget_mm2 on the scene of `prepared`, from the machine of area.fit:
/// all on: the neighbours of the best split so far by area.aim, until none of them is better. Then `prepared` has the
/// machine of the best one, with area.fit: refuse. Large frames are sampled, and the two best splits simulated once
/// more on the frame of the run. The same machines are tried on any host. Shows its progress on a terminal unless
/// `quiet`. Throws a ConfigError, and Interrupted.
report::AreaSearch search_area(Prepared& prepared, const LocatedConfig& given, const InterruptScope& interrupt,
                               bool quiet);

}  // namespace carousel::app
