#pragma once

#include <memory>
#include <vector>

#include "core/config/fields/faults.h"
#include "core/config/fields/topology.h"
#include "ringbus/cycle/fabric/hub.h"
#include "ringbus/cycle/fabric/ports.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/time/wakeup_table.h"

namespace carousel::ringbus::cycle {

/// The links of a simulated machine, as its topology has them, and the hubs between them.
class Network {
 public:
  /// Keeps a reference to the machine. `contexts`: packets that a resource may have in test at once.
  Network(const Machine& machine, const LinkConfig& link, const FaultsConfig& faults, std::int64_t contexts);

  /// The near and far ends of the links at a node, by port. Each node takes its own once.
  struct NodePorts {
    std::vector<InPort> in;
    std::vector<OutPort> out;
  };
  NodePorts ports_at(ResourceId node) const;

  const std::vector<std::unique_ptr<Hub>>& hubs() const { return hubs_; }
  const Wire& wire(std::size_t number) const { return *wires_[number]; }
  /// The least latency of any link; kNever when there are none.
  Cycle least_latency() const;
  /// Announces arrivals on all links. `resources` by number.
  template <class Resources>
  void connect(WakeupTable& wakeups, const Resources& resources) const {
    const auto node = [&](ResourceId id) -> const Agent& {
      if (id.value < resources.size()) return *resources[id.value];
      return *hubs_[id.value - resources.size()];
    };
    for (std::size_t i = 0; i < wires_.size(); ++i) {
      const Topology::Wire& ends = machine_.topology.wires()[i];
      wakeups.connect(wires_[i]->packets, node(ends.from), node(ends.to));
    }
  }

 private:
  const Machine& machine_;
  FaultsConfig faults_;
  std::uint32_t depth_;
  std::size_t egress_places_;
  std::vector<std::unique_ptr<Wire>> wires_;  // as the topology's
  std::vector<std::unique_ptr<Hub>> hubs_;
};

}  // namespace carousel::ringbus::cycle
