#pragma once

#include <string>
#include <vector>

#include "ringbus/cycle/fabric/hub.h"

namespace carousel::ringbus::cycle {

/// A node of a graph that only passes packets on, each by the link of the shortest way to its stop. A packet that finds
/// no egress place waits at the end of its link, and holds up those behind it.
class Router final : public Hub {
 public:
  /// `node`: its number, behind those of the resources. Keeps a reference to the topology.
  Router(ResourceId node, const Topology& topology, std::vector<InPort> in, std::vector<OutPort> out)
      : Hub(std::move(in), std::move(out)), node_(node), topology_(topology) {}

  Cycle next() const override;
  void run(Cycle end) override;
  std::string describe() const override;

 private:
  void step(Cycle now);
  bool take_in(Cycle now);

  ResourceId node_;
  const Topology& topology_;
  std::size_t turn_ = 0;  // the link whose packets are taken first
  Cycle now_ = 0;
};

}  // namespace carousel::ringbus::cycle
