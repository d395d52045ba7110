#pragma once

#include <string>
#include <vector>

#include "core/config/graph/ring.h"
#include "core/config/load/load.h"
#include "ringbus/cycle/traffic/ring_engine.h"
#include "ringbus/time/machine_clocks.h"

namespace carousel::ringbus {

/// Runs the traffic of a configuration on its ring with stops.
inline TrafficResult run_ring(const Config& config) {
  const MachineClocks clocks(config.engine.clock_mhz, config.clocks.synchroniser_cycles);
  const std::int64_t mhz = config.topology.links[*config::stop_ring_entry(config.topology)].mhz;
  return run_ring_traffic(config.topology, config.workload.traffic, clocks.from_core(mhz), config.image.seed, {});
}

/// The machine of a text, and of a file of configs/rings, as users would change it.
inline Config ring_config(const std::string& text) {
  return load_config({text, "ring.yaml"}).config;
}
inline Config ring_file(const std::string& name, const std::vector<std::string>& sets = {}) {
  return load_config(read_config_file(CAROUSEL_SOURCE_DIR "/configs/rings/" + name), sets).config;
}

/// Bytes that are accepted in a cycle of the resources.
inline double accepted_bytes(const Config& config, const TrafficResult& result) {
  return static_cast<double>(result.accepted) * static_cast<double>(config.workload.traffic.packet_bytes) /
         static_cast<double>(result.window_end - result.window_begin);
}

}  // namespace carousel::ringbus
