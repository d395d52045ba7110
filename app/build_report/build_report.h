#pragma once

#include <cstddef>
#include <cstdint>

#include "accel/traverse/verifying_workload.h"
#include "app/run/prepare.h"
#include "app/run/render_job.h"
#include "report/run/report.h"
#include "ringbus/results/run_result.h"

namespace carousel::app {

/// The report of a run that renders a scene. `verifying` is null unless the run was verified.
report::Report build_report(const Prepared& prepared, const RenderJob& job, const ringbus::RunResult& result,
                            const accel::VerifyingWorkload* verifying);

/// Builds the parts that reports of the network alone and of the memory alone share. Its digest is that of no rays.
report::Report report_without_rays(const Prepared& prepared, bool complete, std::uint64_t cycles, std::size_t threads,
                                   double wall_seconds);

}  // namespace carousel::app
