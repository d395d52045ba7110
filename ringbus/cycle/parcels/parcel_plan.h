#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/config/graph/drawn_parts.h"
#include "core/config/graph/graph.h"

namespace carousel::ringbus {

/// What travels over drawn links beside packets (`topology.links.carries`), and between which parts: plain data of a
/// configuration, which must outlive it. Nothing where no such part is drawn.
///
/// These messages wait for nothing but the time of links: every node has room for all of them there are. So neither
/// requests nor answers nor packets hold up one another for ever, and no circle of links can close. What asks for an
/// answer is bounded by places of shape buffers, misses and slots; lines that are written are bounded by nothing, as
/// on wires of their own.
struct ParcelPlan {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// A link that carries more than packets, or none of them.
  struct Link {
    std::uint32_t link = 0;      ///< in the graph
    std::uint32_t wire = kNone;  ///< the topology's wire that it is too; kNone: no packet travels there
  };

  config::Graph graph;
  config::DrawnParts parts;
  std::vector<Link> links;

  bool any() const { return !links.empty(); }
  const config::Graph::Link& drawn(const Link& link) const { return graph.links[link.link]; }
  /// The clock of a node.
  std::int64_t mhz(std::uint32_t node) const { return graph.nodes[node].drawn->mhz; }
  /// The links on which no packet travels, in order.
  std::vector<config::Graph::Link> without_packets() const;
  /// The length of a link in mm, where one between neighbours is `link_mm` long, as wire_length(): from place to place
  /// if its nodes have places; else a node that is no resource stands beside the nearest one.
  double length(const config::Graph::Link& link, double link_mm) const;
  /// The lengths of all without packets, each times its width over `bytes_per_cycle`.
  double lengths_without_packets(std::int64_t bytes_per_cycle, double link_mm) const;

 private:
  friend ParcelPlan plan_parcels(const TopologyConfig& config, std::int64_t line_bytes);
  std::vector<std::uint32_t> beside_;  // by node: the resource beside which it stands
};

/// `line_bytes`: memory.line_bytes. Throws a SimulationError if the drawing has faults, which checked configurations
/// have not.
ParcelPlan plan_parcels(const TopologyConfig& config, std::int64_t line_bytes);

/// Lines for people: the parts and the longest ways to them, in cycles of the resources.
std::string parcel_facts(const ParcelPlan& plan);

}  // namespace carousel::ringbus
