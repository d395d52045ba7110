#pragma once

#include <cstdint>
#include <vector>

#include "ringbus/cycle/parcels/parcel_plan.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The ways of parcels: of all links that carry what they are, the shortest (routes.h).
class ParcelRoutes {
 public:
  /// Keeps a reference to the plan.
  explicit ParcelRoutes(const ParcelPlan& plan);

  struct Exit {
    std::uint32_t port = 0;
    bool through = false;  ///< the next node sends it on as soon as its head has come
  };
  /// The way out of a node to another one.
  Exit exit(Carried what, std::uint32_t node, std::uint32_t stop) const {
    return exits_[(static_cast<std::size_t>(what) * nodes_ + node) * nodes_ + stop];
  }
  /// The cycles of the resources that a way takes: the latencies of its links and of the nodes before them.
  Cycle cycles(Carried what, std::uint32_t from, std::uint32_t to) const;
  /// The links that leave or enter a node, by their places in the plan; those that leave are in the order of ports.
  const std::vector<std::uint32_t>& out(std::uint32_t node) const { return out_[node]; }
  const std::vector<std::uint32_t>& in(std::uint32_t node) const { return in_[node]; }

 private:
  void find_exits(const ParcelPlan& plan, Carried what, const std::vector<std::uint32_t>& ports);

  const ParcelPlan& plan_;
  std::size_t nodes_;
  std::vector<Exit> exits_;  // by what travels, node and stop
  std::vector<std::vector<std::uint32_t>> out_, in_;
};

}  // namespace carousel::ringbus::cycle
