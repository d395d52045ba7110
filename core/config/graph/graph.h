#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "core/config/fields/topology.h"
#include "core/config/graph/node_names.h"

namespace carousel::config {

/// A network as `topology.nodes` and `topology.links` draw it: groups and patterns are written out, and what a link
/// does not say is filled in. Resources come first, in their order, and then the others, kind by kind.
struct Graph {
  struct Node {
    std::string name;
    const GraphNode* drawn;  ///< of the configuration, which must outlive the graph
    std::size_t entry;       ///< its place in topology.nodes
    GraphPoint at;           ///< its place on the die, in mm, if it has one
  };
  /// From node to node, one way.
  struct Link {
    static constexpr std::int64_t kAllLanes = -1;

    std::uint32_t from, to;
    std::int64_t latency_cycles, bytes_per_cycle, depth, virtual_channels;
    std::size_t entry;  ///< its place in topology.links
    bool dateline;
    std::vector<Carried> carries = {};  ///< sorted
    std::int64_t lane = kAllLanes;      ///< of the packets that may take it
    std::string clock = {};             ///< as the drawing names it
    std::int64_t mhz = 0;               ///< of its clock; 0: that of the resources
    std::optional<QueueKind> queue = {};

    bool is_for(std::size_t of) const { return lane == kAllLanes || lane == static_cast<std::int64_t>(of); }
    bool carries_any(std::initializer_list<Carried> some) const;
  };
  /// A packet at `at` on its way to the resource `to` takes this link, if the link is for its lane.
  struct Hop {
    std::uint32_t at, to, link;
    std::size_t entry;  ///< its place in topology.ways
  };

  std::vector<Node> nodes;
  std::vector<Link> links;
  std::uint32_t resources = 0;
  std::size_t lanes = 1;  ///< of packets; each has the links of its own and those of all lanes
  NodeNames names;
  Routing routing = Routing::kShortest;
  std::optional<std::uint32_t> root;  ///< the node at the top for up_down, if it is named
  std::vector<Hop> hops;              ///< the ways that are given, each node, destination and lane once
  bool stacks = false;                ///< resources trace their own rays, and there are no packets
  std::int64_t core_mhz = 1000;       ///< of the resources
  std::int64_t synchroniser_cycles = 0;
  /// By resource: the packet process that keeps its collections, itself for one of these. Empty: each keeps its own.
  std::vector<std::uint32_t> manager_of;

  /// Tells whether packets go from one resource to another: with packet processes, among those of one alone.
  bool packets_go(std::uint32_t from, std::uint32_t to) const {
    return from == to || (!stacks && (manager_of.empty() || manager_of[from] == manager_of[to]));
  }
  /// Those that issue packets, in order.
  std::vector<std::uint32_t> issuers() const;
  /// The numbers of its nodes of a kind, in order.
  std::vector<std::uint32_t> of_kind(GraphNodeKind kind) const;
  /// The node that all packets cross, if it is a bus.
  std::optional<std::uint32_t> bus() const;
  /// Links that are of all lanes, while there are several: packets of one lane may wait for those of another.
  bool lanes_meet() const;
  /// The same nodes with the links alone that carry `what`. Ways of anything but packets are the shortest ones.
  Graph only(Carried what) const;
  /// "r[0] > r[1]"
  std::string name_of(const Link& link) const { return nodes[link.from].name + " > " + nodes[link.to].name; }
};

/// A fault of the drawing and the key that has it.
struct GraphIssue {
  std::string key, message;
};

/// The number of resources that the nodes make.
std::int64_t drawn_resources(const TopologyConfig& config);

/// Fills in which resources overrides name. A name that is no node is left out; check_graph() says so.
void name_overrides(TopologyConfig& config);

/// Writes out the graph; what is wrong with it is appended to `issues`, and left out.
Graph draw_graph(const TopologyConfig& config, std::vector<GraphIssue>& issues);

/// By start: the nodes to which ways lead from it, itself included.
std::vector<std::vector<bool>> ways_of(const Graph& graph, const std::vector<std::uint32_t>& starts);

/// The faults of the whole: nodes without a link, resources between which no way leads packets, ways that go in a
/// circle, a bus with anything but links to and from resources.
void check_ways(const Graph& graph, std::vector<GraphIssue>& issues);

}  // namespace carousel::config
