#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/config/fields/topology.h"

namespace carousel::config {

/// A network as `topology.nodes` and `topology.links` draw it: groups and patterns are written out, and what a link
/// does not say is filled in. Resources come first, in their order, and then the routers.
struct Graph {
  struct Node {
    std::string name;
    const GraphNode* drawn;  ///< of the configuration, which must outlive the graph
    std::size_t entry;       ///< its place in topology.nodes
  };
  /// From node to node, one way.
  struct Link {
    std::uint32_t from, to;
    std::int64_t latency_cycles, bytes_per_cycle, depth;
    std::size_t entry;  ///< its place in topology.links
  };

  std::vector<Node> nodes;
  std::vector<Link> links;
  std::uint32_t resources = 0;

  /// "r[0] > r[1]"
  std::string name_of(const Link& link) const { return nodes[link.from].name + " > " + nodes[link.to].name; }
};

/// A fault of the drawing and the key that has it.
struct GraphIssue {
  std::string key, message;
};

/// The number of resources that the nodes make.
std::int64_t drawn_resources(const TopologyConfig& config);

/// Writes out the graph; what is wrong with it is appended to `issues`, and left out. Nodes of kinds that are not built
/// are left out, too.
Graph draw_graph(const TopologyConfig& config, std::vector<GraphIssue>& issues);

/// The faults of the whole: resources without a link, nodes that no way leads to.
void check_ways(const Graph& graph, std::vector<GraphIssue>& issues);

}  // namespace carousel::config
