#pragma once

#include <stop_token>

#include "app/run/prepare.h"
#include "app/run/render_job.h"
#include "report/run/report.h"
#include "ringbus/results/run_result.h"

namespace carousel::app {

/// The bottleneck of the simulated machine, found by simulating the first rays of the run again with each class of its
/// parts relaxed in turn. `job` is the run's; its raster pass, if any, is not done again.
report::Bottleneck find_bottleneck(const Prepared& prepared, const RenderJob& job, std::stop_token stop);

/// The rate that each class of parts alone would allow: the run's rays over the cycles the class was busy with them.
report::Bound bound_of(const Config& config, const ringbus::RunResult& result);

}  // namespace carousel::app
