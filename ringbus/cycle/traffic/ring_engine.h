#pragma once

#include <cstdint>

#include "core/config/fields/topology.h"
#include "core/config/fields/workload.h"
#include "ringbus/cycle/traffic/traffic_result.h"
#include "ringbus/results/run_result.h"
#include "ringbus/time/clock_ratio.h"

namespace carousel::ringbus {

/// As run_traffic(), where the network is a ring whose stops have no queues (`stops.rule: slots` or `grants`). One
/// thread runs it, as all of its stops are clocked together. `seed`: image.seed; `clock`: of the network.
///
/// Throws SimulationError when a packet is lost.
TrafficResult run_ring_traffic(const TopologyConfig& topology, const TrafficConfig& traffic, const ClockRatio& clock,
                               std::int64_t seed, const RunOptions& options);

}  // namespace carousel::ringbus
