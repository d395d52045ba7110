#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/config/graph/graph.h"

namespace carousel::config {

/// Ways through a graph, one for each pair of nodes, by the graph's rule. A packet goes on as if it started anew at
/// each node, so there is one table a node.
///
/// shortest: by the latency of links, which Dijkstra's algorithm finds from each node. Of equally short ones, a node is
/// reached by the neighbour that is nearest to the start, and of equally near ones by that of the lowest number (as
/// BookSim2's anynet).
///
/// up_down: links that lead nearer to the root, counted in links and then by the node's number, go up; the others go
/// down (M. Schroeder et al., Autonet, IEEE J. Selected Areas in Communications 9 (1991)). Where links down lead to the
/// destination, the shortest such way is taken; else the one that goes up first and is the shortest then. So no way
/// goes up after it has gone down, and links that wait for one another form no circle.
///
/// A plugin's router: by its answers (core/types/router_rule.h). Nothing here keeps such ways from going round either.
///
/// given: by the table, and the shortest where it has no entry. Nothing here keeps such ways from going round.
///
/// Packets of a lane take the links that are for it, and the heights of up_down are those of all links.
class Routes {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  explicit Routes(const Graph& graph, std::size_t lane = 0);

  /// The link, by its number in the graph, by which a packet at `at` goes on to `to`; kNone if no way leads there, or
  /// it is there.
  std::uint32_t link(std::uint32_t at, std::uint32_t to) const { return links_[at * nodes_ + to]; }
  /// Calls `body` with each link of the way, in order.
  template <class Body>
  void for_each_link(std::uint32_t from, std::uint32_t to, const Body& body) const {
    for (std::uint32_t at = from, link; (link = this->link(at, to)) != kNone; at = ends_[link]) body(link);
  }

 private:
  std::size_t nodes_;
  std::vector<std::uint32_t> links_;  // by node, then destination
  std::vector<std::uint32_t> ends_;   // by link: the node to which it leads
};

/// The node at the top for up_down: the one that is named, or else the one whose farthest node is nearest, counted in
/// links in either direction; of several, the first.
std::uint32_t root_of(const Graph& graph);

/// Tells whether the latencies of links, or of nodes where packets visit the nearest owner next, may decide which way a
/// packet takes. They do not where each node has one way to each other, nor where all links have one latency by one
/// key.
bool latencies_choose_ways(const TopologyConfig& config);

}  // namespace carousel::config
