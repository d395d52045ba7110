#pragma once

#include "app/host/exit_status.h"
#include "report/run/report.h"

namespace carousel::app {

/// The exit status of a run that came to an end, after logging what stands in the way of 0. An interrupt wins
/// over a failed verification: the rays compared so far are not all there are.
ExitStatus verdict(const report::Report& report);

}  // namespace carousel::app
