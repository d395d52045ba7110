#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/config/graph/graph.h"
#include "ringbus/topology/routes.h"

namespace carousel::ringbus {

/// Which links wait for which: a packet at the end of a link holds its place there until the next link of its way has
/// one. Where these dependencies form no circle, no set of full links can wait for one another for ever (W. Dally,
/// C. Seitz, Deadlock-Free Message Routing in Multiprocessor Interconnection Networks, IEEE Trans. Computers 36
/// (1987)).
class Dependencies {
 public:
  explicit Dependencies(std::size_t links) : after_(links) {}

  void add(std::uint32_t link, std::uint32_t next);
  void set(std::uint32_t link, std::vector<std::uint32_t> next) { after_[link] = std::move(next); }
  const std::vector<std::uint32_t>& after(std::uint32_t link) const { return after_[link]; }

  /// The links of a circle, in order, that holds the fewest packets of all; empty if there is none. `places`: packets
  /// that a link holds. The search ends with a circle of at most `enough` packets.
  std::vector<std::uint32_t> smallest_circle(const std::vector<std::uint64_t>& places, std::uint64_t enough) const;

 private:
  std::vector<bool> on_circles() const;

  std::vector<std::vector<std::uint32_t>> after_;
};

/// The dependencies of packets with one destination each, from any resource to any other, which always takes them in.
Dependencies traffic_dependencies(const config::Graph& graph, const Routes& routes);

/// The dependencies of packets that visit resources in the order of their numbers, begin with any and come home to it.
/// At a visit a packet holds its place until the link to the next one has a place. `all`: each visits all resources;
/// otherwise any of them. `bounded`: by node, whether its places are; a node with room for all packets makes none wait.
Dependencies visit_dependencies(const config::Graph& graph, const Routes& routes, bool all,
                                const std::vector<bool>& bounded);

}  // namespace carousel::ringbus
