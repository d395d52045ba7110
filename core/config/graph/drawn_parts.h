#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/config/graph/graph.h"

namespace carousel::config {

/// Nodes that hold the lines of memory in turn, so many bytes each.
struct Banks {
  std::vector<std::uint32_t> nodes;  ///< of the graph
  std::int64_t interleave_bytes = 0;
};

/// The parts of a machine that are drawn beside resources and routers, and who reaches which of them over links. A part
/// that is not drawn has its place and its wires beside the links.
struct DrawnParts {
  std::vector<Banks> caches;            ///< a group for each entry of topology.nodes
  std::vector<std::size_t> caches_of;   ///< by resource: the group that it asks; empty without caches
  std::vector<std::uint32_t> spilling;  ///< packet processes that a cache serves, to which their collections may spill
  Banks memories;                       ///< no nodes: one memory, beside the links
  std::vector<std::uint32_t> pools;     ///< of shader workers, in the order of the drawing
  std::vector<std::size_t> pool_of;     ///< by resource: where its completed rays go; empty without pools
  bool new_rays = false, completed_rays = false;  ///< they travel over links

  std::size_t cache_nodes() const;
  /// The node of a resource's pool.
  std::uint32_t pool_node(std::uint32_t resource) const { return pools[pool_of[resource]]; }
};

/// Finds the parts; what is wrong with them and with the ways to them is appended to `issues`. `line_bytes`:
/// memory.line_bytes.
DrawnParts find_parts(const TopologyConfig& config, const Graph& graph, std::int64_t line_bytes,
                      std::vector<GraphIssue>& issues);

}  // namespace carousel::config
