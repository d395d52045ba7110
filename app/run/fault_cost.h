#pragma once

#include <stop_token>

#include "app/run/prepare.h"
#include "report/run/report.h"

namespace carousel::app {

/// Simulates the frame once more without faults, on the cycle engine, and adds to `report` the number of cycles and the
/// result of comparing hits and picture. Marks the report as incomplete if this run is interrupted, and does nothing if
/// the first one was. Shows its progress unless `quiet`.
void compare_without_faults(const Prepared& prepared, std::stop_token stop, bool quiet, report::Report& report);

}  // namespace carousel::app
