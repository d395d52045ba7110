#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "ringbus/cycle/fabric/hub.h"

namespace carousel::ringbus::cycle {

/// Joins a group of a hierarchical topology with the ring of groups. Its egress queues have room for every packet there
/// is, so that neither ring ever waits for the other: a packet that arrives is taken in, and no circle of full queues
/// can close.
class Bridge final : public Hub {
 public:
  /// Ports: 0 of the group, 1 of the ring of bridges (which is missing when there is one group).
  Bridge(std::uint32_t group, const Topology& topology, std::span<const Packet> packets, std::vector<InPort> in,
         std::vector<OutPort> out);

  Cycle next() const override;
  void run(Cycle end) override;
  std::string describe() const override;

 private:
  void step(Cycle now);
  void pass_on(Token token, bool from_group, Cycle now);
  /// Tells whether a packet has anything to do in its group, now that it is at the bridge.
  bool enters(const Packet& packet, bool from_group) const;

  std::uint32_t group_;
  const Topology& topology_;
  std::span<const Packet> packets_;
  Cycle now_ = 0;
};

}  // namespace carousel::ringbus::cycle
