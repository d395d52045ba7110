#pragma once

#include <functional>
#include <stop_token>

#include "app/run/prepare.h"
#include "app/run/render_job.h"
#include "app/sampled/place_census.h"
#include "report/run/report.h"
#include "ringbus/results/run_result.h"

namespace carousel::app {

/// The estimates for the whole frame from the run of a job with a sample. `memory` holds all requests of the run.
report::Sampled estimates(const Prepared& prepared, const RenderJob& job, const PlaceCensus& places,
                          const ringbus::RunResult& result, const ringbus::MemoryLog& memory);

/// The energy of a ray of a run that is complete.
using NjPerRay = std::function<double(const RenderJob& job, const ringbus::RunResult& result)>;

/// Simulates the whole frame, too, and says how far off each estimate of `report` is. Shows its progress on a terminal
/// unless `quiet`. Interrupted, it marks the report as incomplete. `nj_per_ray` is called if there is an estimate of
/// it.
void audit(const Prepared& prepared, const RenderJob& job, std::stop_token stop, bool quiet, const NjPerRay& nj_per_ray,
           report::Report& report);

}  // namespace carousel::app
