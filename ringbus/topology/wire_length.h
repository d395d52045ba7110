#pragma once

#include <cstdint>
#include <vector>

#include "ringbus/topology/topology.h"

namespace carousel::ringbus {

/// The length of a wire in mm, where a link between neighbours is `link_mm` long. A wire of a graph whose nodes have
/// places goes from place to place along the axes. Otherwise the resources stand on a square grid, in rows whose
/// direction alternates, so that one and the next are neighbours; the ring that they make is folded, so that the first
/// and the last are neighbours too. A bridge stands beside the first resource of its group, and a router beside the
/// first resource with a link to or from it. Other wires run along the axes. A bus is one medium past all resources,
/// which stands for each wire that leads to it; those from it have no length.
double wire_length(const Topology& topology, const Topology::Wire& wire, double link_mm);

/// Likewise between two places on that grid, each of a resource.
double place_distance(std::uint32_t resources, std::uint32_t from, std::uint32_t to);

/// A link between two stops of a ring without queues.
struct StopRingWire {
  double mm = 0;
  std::int64_t bytes_per_cycle = 0;
};

/// The links between the stops of all such rings, ring by ring in the order of its graph; none on any other network.
std::vector<StopRingWire> stop_ring_wires(const TopologyConfig& config, double link_mm);

/// The lengths of all wires together, each times its width over `bytes_per_cycle`, which is positive. The medium of a
/// bus counts once, as a wire of that width.
double wire_lengths(const Topology& topology, std::int64_t bytes_per_cycle, double link_mm);

}  // namespace carousel::ringbus
