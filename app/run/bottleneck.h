#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>

#include "app/run/prepare.h"
#include "app/run/render_job.h"
#include "report/run/report.h"
#include "ringbus/results/run_result.h"
#include "ringbus/verdict/pilot_runs.h"

namespace carousel::app {

/// Other seeds of a picture with which a search finds the noise of a run's cycles.
inline constexpr std::uint64_t kNoiseSeeds = 3;

/// The bottleneck of the simulated machine, found by simulating a pilot drawn from all of the run's paths again with
/// each class of parts relaxed in turn. `run` is the run of `job`; a raster pass is not done again with the same seed.
/// `noise` is set to that of the run's cycles if run.noise_seeds asks for it and the search comes to it. Shows its
/// progress on a terminal unless `quiet`. Interrupted, or after an interrupted run, it finds nothing and says so.
report::Bottleneck find_bottleneck(const Prepared& prepared, const RenderJob& job, const ringbus::SearchedRun& run,
                                   std::stop_token stop, bool quiet, std::optional<report::CycleNoise>& noise);

/// The rate that each class of parts alone would allow: the run's rays over the cycles the class was busy with them.
report::Bound bound_of(const ringbus::RunResult& result);

}  // namespace carousel::app
