#pragma once

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "report/run/report.h"
#include "ringbus/results/cycle_result.h"

namespace carousel::app {

/// Fills in everything that needs a simulated clock, after add_ring() and add_links() where there are statistics.
void add_cycles(report::Report& report, const ringbus::cycle::CycleResult& result, const Config& config,
                const accel::Accel& accel);

}  // namespace carousel::app
