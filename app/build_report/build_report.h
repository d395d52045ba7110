#pragma once

#include "accel/traverse/verifying_workload.h"
#include "app/run/prepare.h"
#include "app/run/render_job.h"
#include "report/run/report.h"
#include "ringbus/results/run_result.h"

namespace carousel::app {

/// The report of a run that renders a scene. `verifying` is null unless the run was verified.
report::Report build_report(const Prepared& prepared, const RenderJob& job, const ringbus::RunResult& result,
                            const accel::VerifyingWorkload* verifying);

}  // namespace carousel::app
