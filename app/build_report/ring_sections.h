#pragma once

#include "accel/structure/accel.h"
#include "app/run/ray_census.h"
#include "core/config/config.h"
#include "report/run/report.h"
#include "ringbus/results/run_result.h"

namespace carousel::app {

/// Fills in the sections that come from the counters of the resources: tests, cull planes, packets, collections,
/// resources and throughput. `result` has statistics; `report` has its rays.
void add_ring(report::Report& report, const ringbus::RunResult& result, const Config& config,
              const accel::Accel& accel);

/// Fills in the ranks and their messages, if there are several.
void add_ranks(report::Report& report, const ringbus::RunResult& result);

/// Fills in what rays that look for several hits have found, if there are any.
void add_nearest(report::Report& report, const ringbus::RunResult& result, const Config& config);

/// Fills in the way of the rays and the depth-first baseline, for which it traces rays.
void add_census(report::Report& report, const RayCensus& census, const accel::Accel& accel);

/// Fills in the section of the links.
void add_links(report::Report& report, const ringbus::RunResult& result, const Config& config);
/// Fills in the section of the queues that hand over rays, which only the native engine measures.
void add_ray_queues(report::Report& report, const ringbus::RunResult& result, const Config& config);

/// Tells whether parts of the machine go by other clocks than its resources.
bool several_clocks(const Config& config);
/// Cycles of the resources as a time.
double nanoseconds(const Config& config, double cycles);
/// The name of the clock of a link; `mhz`: as the machine has it, 0 for that of the resources.
std::string clock_of_link(const Config& config, std::int64_t mhz);
/// Fills in the time of the run, once its cycles are known, and the clocks, if there are several.
void add_clocks(report::Report& r, const Config& config);

/// The nodes of a network that is drawn, by their numbers in the lists of the report; absent for other shapes.
std::optional<std::vector<report::DrawnNode>> drawing(const TopologyConfig& topology, bool rays = false);

}  // namespace carousel::app
