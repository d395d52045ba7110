#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace carousel {

/// A node of a drawn network, as a router sees it.
struct RouterNode {
  bool resource = false;      ///< packets stop there; otherwise it only passes them on
  bool placed = false;        ///< it stands on the die
  double x_mm = 0, y_mm = 0;  ///< there
};

/// A link that leaves the node that is asked for.
struct RouterLink {
  std::uint32_t to = 0;  ///< its other node
  std::int64_t latency_cycles = 0;
  std::int64_t bytes_per_cycle = 0;
};

/// Which link takes a packet at `at` on to `to`, which is another node and a resource.
struct RouterQuestion {
  std::span<const RouterNode> nodes;  ///< resources first, in the order of topology.nodes, and then the others by kind
  std::span<const RouterLink> links;  ///< that leave `at` and are for its lane
  std::uint32_t at = 0, to = 0;       ///< nodes
  std::uint32_t lane = 0;
  std::size_t shortest = 0;  ///< the place in `links` of the shortest way; their number if no way leads there
};

/// A router that a plugin brings (`topology.routes`). It is asked for each node, destination and lane, before the run,
/// and its answers are the tables of all nodes: so the verdict on deadlock, `check` and both engines know its ways.
struct RouterRule {
  /// The place in `links` of the link to take; any other number: no way leads there. Any thread may call, several times
  /// for the same question, and must get the same answer.
  std::size_t (*choose)(const RouterQuestion& question) = nullptr;
};

}  // namespace carousel
