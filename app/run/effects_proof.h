#pragma once

#include "app/host/interrupt.h"
#include "app/run/prepare.h"
#include "report/run/report.h"

namespace carousel::app {

/// `verify: effects`: runs the configuration that made `report` again with all effects, and says in it whether that
/// changes anything and what leaving them out spared. Nothing when the run was interrupted.
void prove_effects(const ConfigArguments& arguments, const InterruptScope& interrupt, report::Report& report);

}  // namespace carousel::app
