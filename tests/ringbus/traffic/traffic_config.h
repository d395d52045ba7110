#pragma once

#include "core/config/config.h"

namespace carousel::ringbus {

/// A network for synthetic traffic in virtual time; 1-flit packets, hops of 4 cycles, 6 to get in and out.
inline Config traffic_config(TopologyShape shape, std::int64_t resources, TrafficConfig::Pattern pattern, double rate,
                             std::int64_t packets) {
  Config c;
  c.engine.kind = EngineKind::kCycle;
  c.topology.shape = shape;
  c.topology.resources = resources;
  c.topology.flow = Flow::kBubble;
  c.workload.kind = WorkloadConfig::Kind::kTraffic;
  c.workload.traffic.pattern = pattern;
  c.workload.traffic.rate = rate;
  c.workload.traffic.packets = packets;
  c.workload.traffic.inject_cycles = 3;
  c.workload.traffic.eject_cycles = 3;
  return c;
}

}  // namespace carousel::ringbus
