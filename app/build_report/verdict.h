#pragma once

#include "app/host/exit_status.h"
#include "report/run/report.h"

namespace carousel::app {

/// The exit status of a run that came to an end, `interrupted` if its report is incomplete. Logs each reason for a
/// status other than 0. An interrupt wins over a failed verification, since only some of the rays have been compared.
ExitStatus verdict(const report::Report& report, ExitStatus interrupted = kInterrupted);

}  // namespace carousel::app
