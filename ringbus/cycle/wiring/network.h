#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "core/config/fields/faults.h"
#include "core/config/fields/topology.h"
#include "ringbus/cycle/fabric/hub.h"
#include "ringbus/cycle/fabric/ports.h"
#include "ringbus/cycle/rings/ring_hub.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/time/machine_clocks.h"

namespace carousel::ringbus::cycle {

/// The links of a simulated machine, as its topology has them, and the hubs between them.
class Network {
 public:
  /// Wires that packets share with others, each with the number of its agent.
  using SharedWires = std::map<std::uint32_t, std::uint32_t>;

  /// Keeps a reference to the machine. `topology`: of its configuration. `contexts`: packets that a resource may have
  /// in test at once, by resource. `clocks`: with all that parts use. Nodes have the topology's numbers in the list.
  Network(ChannelList& list, const Machine& machine, const TopologyConfig& topology, const FaultsConfig& faults,
          std::vector<std::int64_t> contexts, MachineClocks clocks, const SharedWires& shared = {});

  /// The near and far ends of the links at a node, by port. Each node takes its own once.
  struct NodePorts {
    std::vector<InPort> in;
    std::vector<OutPort> out;
  };
  NodePorts ports_at(ResourceId node) const;

  const std::vector<std::unique_ptr<Hub>>& hubs() const { return hubs_; }
  const MachineClocks& clocks() const { return clocks_; }
  /// The rings whose stops have no queues, in order.
  const std::vector<const RingHub*>& rings() const { return rings_; }
  /// The far end of a wire, and its near end, which is the same but where others share it.
  Wire& far(std::size_t number) const { return far_[number] ? *far_[number] : *wires_[number]; }
  Wire& near(std::size_t number) const { return *wires_[number]; }

 private:
  /// The time over a link and back that its clocks add to the latency both ways, in its cycles.
  Cycle crossings(const Topology::Wire& wire, Cycle latency) const;

  const Machine& machine_;
  FaultsConfig faults_;
  std::vector<std::int64_t> contexts_;  // by resource
  MachineClocks clocks_;
  std::vector<std::unique_ptr<Wire>> wires_;  // as the topology's
  std::vector<std::unique_ptr<Wire>> far_;    // likewise; null unless others share it
  std::vector<std::unique_ptr<Hub>> hubs_;
  std::vector<const RingHub*> rings_;
};

}  // namespace carousel::ringbus::cycle
