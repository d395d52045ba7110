#pragma once

#include "app/host/interrupt.h"
#include "app/run/prepare.h"
#include "report/run/report.h"

namespace carousel::app {

/// `verify: effects`: runs the configuration that made `report` again with all effects, and adds to the report the
/// comparison of both runs. The host's time is that of a sample of the frame, of both in turn, several times. Marks the
/// report as incomplete if the second run is interrupted, and does nothing if the first one was. Shows the progress of
/// that run unless `quiet`.
void prove_effects(const ConfigArguments& arguments, const Prepared& by_demand, const InterruptScope& interrupt,
                   bool quiet, report::Report& report);

}  // namespace carousel::app
