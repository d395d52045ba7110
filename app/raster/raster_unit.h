#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>

#include "app/run/prepare.h"
#include "app/run/render_job.h"
#include "report/sections/rays/raster_unit.h"
#include "ringbus/results/class_use.h"

namespace carousel::app {

struct RasterPass {
  bool complete = true;
  report::RasterUnit cost{};
};

/// Does the raster pass of `job` in the simulated machine, where it takes time there (raster.time: cycles): a unit with
/// the ports of a builder, alone with the first L2 and a memory. First chunks of 64 triangles are set up: it reads
/// their vertices and the transforms of their instances, and writes a number of 8 bytes for each tile that a triangle
/// touches. Then each tile is drawn: it reads its list, and the vertices and transforms again, and writes its samples.
/// A task of either kind holds the unit for the slower of its two stages. `cached`: lines of the shared caches, before
/// and after. Absent where the pass takes no time.
std::optional<RasterPass> rasterise_in_machine(const Prepared& p, const RenderJob& job, const std::stop_token& stop,
                                               ringbus::cycle::CacheLines& cached);

}  // namespace carousel::app
