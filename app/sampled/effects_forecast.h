#pragma once

#include "app/run/prepare.h"
#include "app/run/render_job.h"
#include "report/run/report.h"

namespace carousel::app {

/// Foretells in `report.effects` the cycles that the frame would take with all effects of light: the work that they add
/// is counted at the hits of a sample of the frame's paths, traced depth first on this thread. Only for pictures of the
/// cycle engine with `shading.effects: auto`; others get no section.
void foretell_effects(const Prepared& prepared, const RenderJob& job, report::Report& report);

/// Adds the cycles that a run with all effects took, if there was one (verify: effects).
void judge_forecast(report::Report& report);

}  // namespace carousel::app
