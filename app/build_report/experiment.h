#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "app/host/interrupt.h"
#include "app/run/prepare.h"
#include "app/run/render_job.h"
#include "app/trace/trace_file.h"
#include "report/run/report.h"
#include "ringbus/results/class_use.h"
#include "ringbus/results/memory_request.h"
#include "ringbus/results/ray_times.h"

namespace carousel::app {

/// A frame of a series, for run_rays().
struct SeriesFrame {
  ringbus::cycle::CacheLines cached;  ///< lines of the shared caches, at its start and then at its end
  ringbus::cycle::CacheLines began;   ///< set by run_rays(): those at its start
  bool last = false;                  ///< the search for the bottleneck follows it
};

/// Simulates the rays of `job`, and all that the configuration asks for besides: the verification of the hits, the
/// search for the bottleneck, the run without faults, the run with all effects. An interrupted part marks the report as
/// incomplete. `trace`, if not null, gets the events of the run and is written as soon as they are there; `memory`, if
/// not null, gets the requests of the run to the simulated memory; `heat`, one a pixel if not empty, the cost of
/// the pixels; `frame`, if not null, is that of a series. Shows its progress on a terminal unless `quiet`. Throws
/// ConfigError and FileError.
report::Report run_rays(const ConfigArguments& arguments, const Prepared& prepared, RenderJob& job,
                        const InterruptScope& interrupt, bool quiet, TraceFile* trace = nullptr,
                        ringbus::MemoryLog* memory = nullptr, std::span<ringbus::PixelCost> heat = {},
                        SeriesFrame* frame = nullptr);

/// Runs a workload without rays: synthetic traffic on the network alone, or requests to the memory alone. Throws
/// ConfigError and FileError.
report::Report run_without_rays(const Prepared& prepared, const InterruptScope& interrupt, bool quiet);

}  // namespace carousel::app
