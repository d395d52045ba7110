#pragma once

#include <cstdint>
#include <functional>

#include "app/host/interrupt.h"
#include "app/run/prepare.h"
#include "app/run/render_job.h"
#include "report/run/report.h"

namespace carousel::app {

/// Takes the picture of a frame by its number; `last` of the series, or of what was done of it.
using TakeFrame = std::function<void(const RenderJob& job, std::int64_t frame, bool last)>;

/// Shows the frames of a series one after another, of which `prepared` has the first: brings scene and structure to its
/// moment, and simulates its rays as run_rays() does, with the shared caches as the frame before has left them. In the
/// cycle engine the builder works before the rays, alone with the memory, and lines that it makes out of date leave the
/// caches. The report is that of the last frame, with a row for each. An interrupted series ends with the frame that
/// was interrupted, and is incomplete. Throws ConfigError, SceneError and FileError.
report::Report run_series(const ConfigArguments& arguments, Prepared& prepared, const InterruptScope& interrupt,
                          bool quiet, const TakeFrame& take);

}  // namespace carousel::app
