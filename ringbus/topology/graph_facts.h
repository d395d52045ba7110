#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/config/graph/graph.h"
#include "core/config/graph/ring.h"
#include "ringbus/topology/graph/cuts.h"
#include "ringbus/topology/plan.h"

namespace carousel::ringbus {

/// The graph of `topology.nodes` and `topology.links`. Throws a SimulationError if it has faults, which checked
/// configurations have not.
config::Graph draw_whole(const TopologyConfig& config);

/// Likewise, with the links alone that carry packets.
config::Graph draw_checked(const TopologyConfig& config);

/// The length of a link between two nodes with places, along the axes.
double link_mm(const config::Graph& graph, const config::Graph::Link& link);

/// A few links by name.
std::string circle_text(const config::Graph& graph, const std::vector<std::uint32_t>& circle);

/// The ways of a graph between all pairs of resources in each lane, each with itself included: what a uniform load
/// would meet.
struct GraphFacts {
  std::size_t resources = 0, routers = 0, links = 0, ways = 0;
  std::string bus;         ///< that all packets cross; empty without one
  std::string served;      ///< a line that says which packet process serves which resources; empty without such
  double mean_nodes = 0;   ///< on a way, first and last included
  double mean_cycles = 0;  ///< of the resources, that links and the nodes before them take
  std::string longest_from, longest_to;
  std::int64_t longest_cycles = 0;
  std::uint64_t diameter = 0;       ///< most links on a way
  std::string busiest;              ///< the link, or bus, that most ways use for its width and clock
  std::uint64_t busiest_pairs = 0;  ///< ways over it
  /// Load at which the busiest link would be full: flits of the width of topology.link for each resource and cycle of
  /// the resources.
  double bound = 0;
  Cut halves;                     ///< the narrowest cut
  std::string halves_links;       ///< a few of its links by name
  std::optional<double> wire_mm;  ///< of all links together, where all nodes have places
  double wire_bit_mm = 0;         ///< likewise, each times its bits
};
/// `traffic`: packets that keep their lanes take one with the fewest links, and of several each in turn.
GraphFacts graph_facts(const TopologyConfig& config, bool traffic = false);

/// Why rings whose stops have no queues cannot stop by themselves, and whether one of their stops may wait for ever.
std::string stop_rings_text(const config::Graph& graph, const std::vector<config::StopRing>& rings);

/// By node: a packet that gets off a ring there may wait for a place.
std::vector<bool> few_places(const config::Graph& graph);

/// Whether packets with one destination each, as in synthetic traffic, can stop one another.
DeadlockVerdict traffic_verdict(const TopologyConfig& config);

}  // namespace carousel::ringbus
