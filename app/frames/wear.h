#pragma once

#include <stop_token>

#include "accel/structure/accel.h"
#include "app/run/prepare.h"
#include "report/sections/structure/frames.h"

namespace carousel::app {

/// Builds a structure for the frame beside the refitted one, and writes down how the two compare without a machine.
accel::Accel rebuild_beside(const Prepared& prepared, report::Frame& row);

/// Says if a rebuild would have paid in the simulated machine. Where it might, were the rays' time to go down as their
/// tests do, the rays are simulated in `rebuilt` as well, with caches that hold none of it. The row has the cycles of
/// the frame, of its refit, and of its rebuild. An interrupted judgement says nothing.
void judge_wear(const Prepared& prepared, const accel::Accel& rebuilt, const std::stop_token& stop, report::Frame& row);

}  // namespace carousel::app
