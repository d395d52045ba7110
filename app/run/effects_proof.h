#pragma once

#include "app/host/interrupt.h"
#include "app/run/prepare.h"
#include "report/run/report.h"

namespace carousel::app {

/// `verify: effects`: runs the configuration that made `report` again with all effects, and adds to the report the
/// result of comparing both runs and the work that was saved. Does nothing if the run was interrupted.
void prove_effects(const ConfigArguments& arguments, const InterruptScope& interrupt, report::Report& report);

}  // namespace carousel::app
