#pragma once

#include <span>
#include <string>
#include <vector>

#include "ringbus/cycle/fabric/hub.h"

namespace carousel::ringbus::cycle {

/// One medium for all: moves one packet at a time. A test packet goes from its owner to all resources that look at it
/// at once, and an answer to the owner. Resources take turns; a resource whose packet would not find a place wherever
/// it goes is passed over.
class Bus final : public Hub {
 public:
  /// Ports by resource.
  Bus(const Topology& topology, std::span<const Packet> packets, std::vector<InPort> in, std::vector<OutPort> out);

  Cycle next() const override;
  void run(Cycle end) override;
  std::string describe() const override { return ""; }

 private:
  void move_one(Cycle now);
  /// Fills in listeners_ for a packet that comes from a resource.
  void find_listeners(const Token& token, ResourceId from);

  const Topology& topology_;
  std::span<const Packet> packets_;
  std::vector<std::uint32_t> listeners_;  // resources to which a packet goes
  std::size_t turn_ = 0;
  Cycle now_ = 0, free_at_ = 0;
};

}  // namespace carousel::ringbus::cycle
