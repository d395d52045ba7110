#pragma once

#include "core/config/config.h"
#include "ringbus/cycle/traffic/traffic_result.h"
#include "ringbus/results/run_result.h"

namespace carousel::ringbus {

/// The network alone, under virtual time: synthetic packets instead of rays, no scene. Deterministic, the same for
/// any number of threads. See ringbus/cycle/traffic/traffic_node.h for the pipeline.
///
/// Throws SimulationError when the network gets stuck, with who waits for whom.
TrafficResult run_traffic(const Config& config, const RunOptions& options);

}  // namespace carousel::ringbus
