#pragma once

#include "core/config/graph/graph.h"
#include "ringbus/time/machine_clocks.h"

namespace carousel::ringbus {

/// The time of a message alone over links, one after another, from an edge that all clocks have in common. Each node
/// and link goes by its own clock.
class WayTime {
 public:
  /// Keeps references to both.
  WayTime(const config::Graph& graph, const MachineClocks& clocks) : graph_(graph), clocks_(clocks) {}

  /// `link` leaves the node to which the one before led.
  void go(const config::Graph::Link& link) {
    const GraphNode &from = *graph_.nodes[link.from].drawn, &to = *graph_.nodes[link.to].drawn;
    const Cycle leaves = clocks_.between(from.mhz, link.mhz).enter(at_ + static_cast<Cycle>(from.latency_cycles));
    at_ = clocks_.between(link.mhz, to.mhz).enter(leaves + static_cast<Cycle>(link.latency_cycles));
    mhz_ = to.mhz;
  }
  /// By the clock of the resources.
  Cycle cycles() const { return clocks_.from_core(mhz_).to_core(at_); }

 private:
  const config::Graph& graph_;
  const MachineClocks& clocks_;
  Cycle at_ = 0;          // by the clock of the node to which it has come
  std::int64_t mhz_ = 0;  // of that
};

}  // namespace carousel::ringbus
