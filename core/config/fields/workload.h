#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "core/config/fields/field.h"

namespace carousel {

struct TrafficConfig {
  enum class Pattern { kUniform, kTornado, kNeighbour, kHotspot, kBursty, kExchange } pattern = Pattern::kUniform;
  enum class SourceQueues { kShared, kPerDirection } source_queues = SourceQueues::kShared;
  double rate = 0.1;
  std::int64_t packets = 100000;
  std::int64_t packet_bytes = 32;
  std::int64_t inject_cycles = 1, eject_cycles = 1;
  double warmup_fraction = 0.1;
  std::int64_t hotspot = 0;
  double hotspot_fraction = 0.25;
  std::int64_t burst_packets = 8;
  std::string sources, destinations;  ///< nodes of a graph; empty: all resources
  std::int64_t reply_bytes = 0, serve_cycles = 0;
};

template <>
inline constexpr auto kEnumNames<TrafficConfig::Pattern> = [] {
  using enum TrafficConfig::Pattern;
  return names<TrafficConfig::Pattern>({{kUniform, "uniform"},
                                        {kTornado, "tornado"},
                                        {kNeighbour, "neighbour"},
                                        {kHotspot, "hotspot"},
                                        {kBursty, "bursty"},
                                        {kExchange, "exchange"}});
}();

template <>
inline constexpr auto kEnumNames<TrafficConfig::SourceQueues> = [] {
  using enum TrafficConfig::SourceQueues;
  return names<TrafficConfig::SourceQueues>({{kShared, "shared"}, {kPerDirection, "per_direction"}});
}();

/// A workload of a plugin; there is none of this program.
enum class OwnWorkload : std::uint32_t {};
template <>
inline constexpr std::string_view kAddedAs<OwnWorkload> = "workload";

struct WorkloadConfig {
  enum class Kind { kRays, kRaysFrom, kTraffic, kMemoryTrace, kPlugin } kind = Kind::kRays;
  std::string rays_from;     ///< ray CSV; its path is relative to the config's folder, then to the working one
  std::string memory_trace;  ///< CSV of memory requests, likewise
  TrafficConfig traffic;
  OwnWorkload own{};                      ///< with kPlugin
  std::map<std::string, double> options;  ///< of that workload, all that it has
};

namespace config {

template <class V>
void describe(V& v, TrafficConfig& c) {
  v.choice("pattern", c.pattern, "The rule that chooses the destination of a packet.");
  v.choice("source_queues", c.source_queues,
           "A source has one queue, whose first packet holds up all others, or one for each way out.");
  v.field("rate", c.rate, RealRange{0, 1, true}, "packets per resource and cycle", "The rate at which packets start.");
  v.field("packets", c.packets, IntRange{1, 1'000'000'000'000}, "packets",
          "The number of packets, those of the warm-up included.");
  v.field("packet_bytes", c.packet_bytes, IntRange{1, 65535}, "bytes", "The size of a packet.");
  v.field("inject_cycles", c.inject_cycles, IntRange{0, 1'000'000}, "cycles",
          "The time from a packet's creation to its start on a free link.");
  v.field("eject_cycles", c.eject_cycles, IntRange{0, 1'000'000}, "cycles",
          "The time from a packet's arrival at its last resource to its delivery.");
  v.field("warmup_fraction", c.warmup_fraction, RealRange{0, 0.9}, "",
          "The first part of the time in which packets are created. Nothing is measured in it.");
  v.field("hotspot", c.hotspot, IntRange{0, kMaxResources - 1}, "", "The number of the resource that is the hotspot.");
  v.field("hotspot_fraction", c.hotspot_fraction, RealRange{0, 1}, "",
          "The part of the packets that goes to the hotspot. The rest goes anywhere.");
  v.field("burst_packets", c.burst_packets, IntRange{1, 1'000'000}, "packets",
          "The mean number of packets of a burst, which are created in successive cycles.");
  v.field("sources", c.sources, "",
          "The nodes of a graph that create packets, such as r[0..3]; empty is all resources.");
  v.field("destinations", c.destinations, "",
          "The nodes of a graph to which uniform packets go, such as r[4]; empty is all resources.");
  v.field("reply_bytes", c.reply_bytes, IntRange{0, 65535}, "bytes",
          "The size of the answer that a packet on a ring with stops calls for; 0 is none. A packet is delivered when "
          "its answer is.");
  v.field("serve_cycles", c.serve_cycles, IntRange{0, 1'000'000}, "cycles",
          "The time from the arrival of a packet to the departure of its answer.");
}

}  // namespace config
}  // namespace carousel
