#pragma once

#include <span>
#include <string_view>

#include "core/config/fields/workload.h"

namespace carousel {

/// The keys that a workload without rays feels; its machine has no other parts.
struct Workloads {
  WorkloadConfig::Kind kind;
  std::string_view otherwise;
  std::span<const std::string_view> keys;
};
inline constexpr std::string_view kOfTraffic[] = {"schema_version",
                                                  "engine.kind",
                                                  "engine.threads",
                                                  "engine.memory_limit_mib",
                                                  "engine.clock_mhz",
                                                  "clocks",
                                                  "topology.resources",
                                                  "topology.shape",
                                                  "topology.rings",
                                                  "topology.flow",
                                                  "topology.nodes",
                                                  "topology.links",
                                                  "topology.groups",
                                                  "topology.routes",
                                                  "topology.root",
                                                  "topology.ways",
                                                  "topology.channels",
                                                  "topology.link.virtual_channels",
                                                  "topology.link.depth",
                                                  "topology.link.latency_cycles",
                                                  "image.seed",
                                                  "topology.link.bytes_per_cycle",
                                                  "workload",
                                                  "vary",
                                                  "verify"};
inline constexpr std::string_view kOfMemoryTrace[] = {"schema_version",
                                                      "engine.kind",
                                                      "engine.memory_limit_mib",
                                                      "engine.clock_mhz",
                                                      "memory.dram",
                                                      "workload",
                                                      "memory.dram_latency_cycles",
                                                      "memory.dram_bytes_per_cycle",
                                                      "clocks.core",
                                                      "vary",
                                                      "verify"};
inline constexpr Workloads kWithoutRays[] = {
    {WorkloadConfig::Kind::kTraffic, "synthetic traffic does not meet it", kOfTraffic},
    {WorkloadConfig::Kind::kMemoryTrace, "requests to memory do not meet it", kOfMemoryTrace}};

}  // namespace carousel
