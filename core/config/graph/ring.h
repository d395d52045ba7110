#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/config/graph/graph.h"

namespace carousel::config {

/// A drawn ring whose stops have no queues (`stops.rule: slots` or `grants`), which is the whole network.
struct StopRing {
  const GraphLink* drawn = nullptr;  ///< of the configuration, which must outlive it
  std::size_t entry = 0;             ///< its place in topology.links
  std::vector<std::uint32_t> nodes;  ///< in the order of the ring; those of the graph
  std::int64_t latency_cycles = 1, bytes_per_cycle = 1;

  std::size_t directions() const { return drawn->both ? 2 : 1; }
  std::size_t rings() const { return static_cast<std::size_t>(drawn->stops.rings); }
  /// The link of the graph by which a ring leads from the place `segment` on the ring to the next, or back from there
  /// in direction 1: the order in which draw_graph() writes the links of such a ring.
  std::size_t link(std::size_t segment, std::size_t direction, std::size_t ring) const {
    return (segment * directions() + direction) * rings() + ring;
  }
};

/// Tells whether the entry draws a ring whose stops have no queues.
inline bool has_stops(const GraphLink& link) {
  return link.stops.rule != RingStops::Rule::kQueues;
}

/// The place in topology.links of the first ring whose stops have no queues; absent without one, and on other shapes.
std::optional<std::size_t> stop_ring_entry(const TopologyConfig& config);

/// That ring. `config`: a checked configuration that has one.
StopRing stop_ring(const TopologyConfig& config, const Graph& graph);

/// The resources that a pattern of names stands for, in its order; all of them if it is empty. Of none, `error` says
/// why there are none.
std::vector<std::uint32_t> named_resources(const TopologyConfig& config, const std::string& pattern,
                                           std::string& error);

}  // namespace carousel::config
