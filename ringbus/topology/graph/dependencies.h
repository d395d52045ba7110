#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/config/graph/graph.h"
#include "core/config/graph/ring.h"
#include "core/types/ids.h"
#include "ringbus/topology/graph/routes.h"

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
  /// Adds those of others between the same links.
  void join(const Dependencies& others) {
    for (std::uint32_t link = 0; link < after_.size(); ++link)
      for (const std::uint32_t next : others.after_[link]) add(link, next);
  }
  const std::vector<std::uint32_t>& after(std::uint32_t link) const { return after_[link]; }

  /// The links of a circle, in order, that holds the fewest packets of all; empty if there is none. `places`: packets
  /// that a link holds. The search ends with a circle of at most `enough` packets.
  std::vector<std::uint32_t> smallest_circle(const std::vector<std::uint64_t>& places, std::uint64_t enough) const;

  /// By link: it may be part of a circle. The others are not.
  std::vector<bool> on_circles() const;

 private:
  std::vector<std::vector<std::uint32_t>> after_;
};

/// The dependencies of packets with one destination each, from any resource to any other, which always takes them in.
Dependencies traffic_dependencies(const config::Graph& graph, const Routes& routes);

/// The dependencies of packets that visit resources in the order of a round, begin with any and come home to it.
/// At a visit a packet holds its place until the link to the next one has a place. `round`: by resource, the one after
/// it, if each visits all; empty: each visits any of them. `bounded`: by node, whether its places are; a node with room
/// for all packets makes none wait.
Dependencies visit_dependencies(const config::Graph& graph, const Routes& routes, std::span<const ResourceId> round,
                                const std::vector<bool>& bounded);

/// Puts rings whose stops have no queues in the place of their links. Nothing waits on such a ring but for a place at a
/// stop that has few (`bounded`, by node): that keeps the slots full which all others wait for. So each link of the
/// ring waits for all to which packets go on from such stops.
void join_stop_rings(Dependencies& waits, const config::Graph& graph, const std::vector<config::StopRing>& rings,
                     const std::vector<bool>& bounded);

}  // namespace carousel::ringbus
