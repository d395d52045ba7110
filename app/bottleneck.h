#pragma once

#include <cstdint>
#include <stop_token>

#include "app/frame.h"
#include "app/prepare.h"
#include "report/report.h"
#include "ringbus/run_result.h"

namespace carousel::app {

/// What limits the simulated machine, found by simulating the first rays of the run again with each class of its
/// parts lifted in turn. `first_rays` as Frame's.
report::Bottleneck find_bottleneck(const Prepared& prepared, std::uint64_t first_rays, std::stop_token stop);

/// What each class of parts alone would allow: the run's rays over the cycles the class was busy with them.
report::Bound bound_of(const Config& config, const ringbus::RunResult& result);

}  // namespace carousel::app
