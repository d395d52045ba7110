#pragma once

#include "app/run/prepare.h"
#include "report/run/report.h"
#include "ringbus/cycle/traffic/traffic_result.h"

namespace carousel::app {

/// The report of a run of synthetic traffic: no scene, no rays.
report::Report traffic_report(const Prepared& prepared, const ringbus::TrafficResult& result);

}  // namespace carousel::app
