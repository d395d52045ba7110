#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "core/config/fields/faults.h"
#include "core/config/fields/topology.h"
#include "ringbus/cycle/fabric/hub.h"
#include "ringbus/cycle/fabric/ports.h"
#include "ringbus/protocol/machine.h"

namespace carousel::ringbus::cycle {

/// The links of a simulated machine, as its topology has them, and the hubs between them.
class Network {
 public:
  /// Wires that packets share with others, each with the number of its agent.
  using SharedWires = std::map<std::uint32_t, std::uint32_t>;

  /// Keeps a reference to the machine. `contexts`: packets that a resource may have in test at once. Nodes have the
  /// topology's numbers in the list.
  Network(ChannelList& list, const Machine& machine, const LinkConfig& link, const FaultsConfig& faults,
          std::int64_t contexts, const SharedWires& shared = {});

  /// The near and far ends of the links at a node, by port. Each node takes its own once.
  struct NodePorts {
    std::vector<InPort> in;
    std::vector<OutPort> out;
  };
  NodePorts ports_at(ResourceId node) const;

  const std::vector<std::unique_ptr<Hub>>& hubs() const { return hubs_; }
  /// The far end of a wire, and its near end, which is the same but where others share it.
  Wire& far(std::size_t number) const { return far_[number] ? *far_[number] : *wires_[number]; }
  Wire& near(std::size_t number) const { return *wires_[number]; }

 private:
  const Machine& machine_;
  FaultsConfig faults_;
  std::size_t egress_places_;
  std::vector<std::unique_ptr<Wire>> wires_;  // as the topology's
  std::vector<std::unique_ptr<Wire>> far_;    // likewise; null unless others share it
  std::vector<std::unique_ptr<Hub>> hubs_;
};

}  // namespace carousel::ringbus::cycle
