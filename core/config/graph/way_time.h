#pragma once

#include <cstdint>

#include "core/config/graph/graph.h"

namespace carousel::config {

/// The time of a message alone over links, one after another, from an edge that all clocks have in common. Each node
/// and link goes by its own clock. What comes to another clock is taken over at its next edge, and then goes through
/// the synchroniser.
class WayTime {
 public:
  /// Keeps a reference.
  explicit WayTime(const Graph& graph) : graph_(graph) {}

  /// `link` leaves the node to which the one before led.
  void go(const Graph::Link& link) {
    const GraphNode &from = *graph_.nodes[link.from].drawn, &to = *graph_.nodes[link.to].drawn;
    mhz_ = from.mhz;
    at_ += from.latency_cycles;
    enter(link.mhz);
    at_ += link.latency_cycles;
    enter(to.mhz);
  }
  /// By the clock of the resources.
  std::int64_t cycles() const { return edge(0); }

 private:
  std::int64_t of(std::int64_t mhz) const { return mhz == 0 ? graph_.core_mhz : mhz; }
  /// The first edge of that clock that is not before the present moment.
  std::int64_t edge(std::int64_t mhz) const {
    return of(mhz) == of(mhz_) ? at_ : (at_ * of(mhz) + of(mhz_) - 1) / of(mhz_);
  }
  void enter(std::int64_t mhz) {
    const bool other = of(mhz) != of(mhz_);
    at_ = edge(mhz) + (other ? graph_.synchroniser_cycles : 0);
    mhz_ = mhz;
  }

  const Graph& graph_;
  std::int64_t at_ = 0;   // by the clock of the node to which it has come
  std::int64_t mhz_ = 0;  // of that
};

}  // namespace carousel::config
