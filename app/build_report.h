#pragma once

#include <optional>

#include "accel/verifying_workload.h"
#include "app/frame.h"
#include "app/prepare.h"
#include "report/report.h"
#include "ringbus/native_engine.h"

namespace carousel::app {

/// The report of a native run. `verifying` is null unless the run was verified.
report::Report build_report(const Prepared& prepared, const Frame& frame, const ringbus::RunResult& result,
                            const accel::VerifyingWorkload* verifying);

}  // namespace carousel::app
