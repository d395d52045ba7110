#pragma once

#include <stop_token>

#include "app/run/prepare.h"
#include "app/run/render_job.h"
#include "report/run/report.h"
#include "ringbus/results/run_result.h"

namespace carousel::app {

/// The bottleneck of the simulated machine, found by simulating a pilot drawn from all of the run's paths again with
/// each class of parts relaxed in turn. `run` is the run of `job`; a raster pass is not done again. Shows its progress
/// on a terminal unless `quiet`. Interrupted, or after an interrupted run, it finds nothing and says so.
report::Bottleneck find_bottleneck(const Prepared& prepared, const RenderJob& job, const ringbus::RunResult& run,
                                   std::stop_token stop, bool quiet);

/// The rate that each class of parts alone would allow: the run's rays over the cycles the class was busy with them.
report::Bound bound_of(const ringbus::RunResult& result);

}  // namespace carousel::app
