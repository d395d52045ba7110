#pragma once

#include <cstdint>

#include "core/config/fields/engine.h"
#include "core/config/fields/topology.h"
#include "core/config/fields/workload.h"
#include "ringbus/time/clock.h"
#include "ringbus/time/clock_ratio.h"

namespace carousel::ringbus::cycle {

/// The parts of the configuration that a node follows.
struct TrafficNodeSettings {
  Cycle inject_cycles = 0, eject_cycles = 0;
  Cycle link_latency = 1;
  std::uint32_t link_depth = 1;
  std::uint32_t packet_bytes = 1;
  std::uint16_t flits = 1;   ///< flits of a packet
  bool shared_queue = true;  ///< the source has one queue for all packets
  std::uint16_t pieces = 1;  ///< in which a packet goes from node to node: its flits, or the packet
  ClockRatio clock = {};     ///< of the node, by which all but creation and delivery goes
};

inline TrafficNodeSettings traffic_node_settings(const TrafficConfig& traffic, const LinkConfig& link,
                                                 ClockRatio clock = {}) {
  return {static_cast<Cycle>(traffic.inject_cycles),
          static_cast<Cycle>(traffic.eject_cycles),
          static_cast<Cycle>(link.latency_cycles),
          static_cast<std::uint32_t>(link.depth),
          static_cast<std::uint32_t>(traffic.packet_bytes),
          static_cast<std::uint16_t>(ceil_div(static_cast<std::uint64_t>(traffic.packet_bytes),
                                              static_cast<std::uint64_t>(link.bytes_per_cycle))),
          traffic.source_queues == TrafficConfig::SourceQueues::kShared,
          1,
          clock};
}

}  // namespace carousel::ringbus::cycle
