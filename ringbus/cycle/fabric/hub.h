#pragma once

#include <memory>
#include <span>
#include <vector>

#include "ringbus/cycle/fabric/ports.h"
#include "ringbus/cycle/time/agent.h"
#include "ringbus/packets/packet.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus::cycle {

/// A node of the network that is no resource.
class Hub : public Agent {
 public:
  Hub(std::vector<InPort> in, std::vector<OutPort> out) : in_(std::move(in)), out_(std::move(out)) {}
  /// The near ends of its links, by port.
  const std::vector<OutPort>& out() const { return out_; }

 protected:
  std::vector<InPort> in_;
  std::vector<OutPort> out_;
};

/// The topology's hub number `hub`, with its ports. Keeps references to the topology and the packets.
std::unique_ptr<Hub> make_hub(std::uint32_t hub, const Topology& topology, std::span<const Packet> packets,
                              std::vector<InPort> in, std::vector<OutPort> out);

}  // namespace carousel::ringbus::cycle
