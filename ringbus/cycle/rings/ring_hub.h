#pragma once

#include <string>
#include <vector>

#include "ringbus/cycle/fabric/hub.h"
#include "ringbus/cycle/rings/ring_docks.h"

namespace carousel::ringbus::cycle {

/// A ring whose stops have no queues, in a machine of rays.
///
/// A packet of F flits over h links, with nobody in its way and ports of p cycles a flit, is at its node after
///     1 + (F p - 1 + h latency_cycles + p - 1) + 1
/// cycles with slots; with grants, RingShape::alone() stands in the middle.
class RingHub final : public Hub {
 public:
  /// `node`: its number. Ports are those of its wires.
  RingHub(ResourceId node, const TopologyConfig& config, const Topology& topology, std::vector<InPort> in,
          std::vector<OutPort> out);

  Cycle next() const override { return docks_.next(now_); }
  void run(Cycle end) override;
  std::string describe() const override { return docks_.describe(number_); }

  const RingDocks<Token>& docks() const { return docks_; }
  /// Calls `body` with each of its links, as drawn, and with what that has moved in cycles of the ring.
  template <class Body>
  void for_each_link(const Body& body) const {
    const config::StopRing& ring = docks_.shape().drawn;
    for (std::size_t i = ring.first; i < ring.first + ring.links(); ++i)
      body(docks_.graph().links[i], docks_.fabric().links().all()[i]);
  }

 private:
  std::size_t number_;  // among the hubs
  RingDocks<Token> docks_;
  Cycle now_ = 0;
};

}  // namespace carousel::ringbus::cycle
