#pragma once

#include <stop_token>

#include "app/run/prepare.h"
#include "report/run/report.h"

namespace carousel::app {

/// Simulates the frame once more without faults, and adds to `report` how many cycles that takes and whether hits and
/// picture are the same. On the cycle engine. Leaves the report as it is when one of the two was interrupted.
void compare_without_faults(const Prepared& prepared, std::stop_token stop, report::Report& report);

}  // namespace carousel::app
