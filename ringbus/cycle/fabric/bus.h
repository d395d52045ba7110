#pragma once

#include <span>
#include <string>
#include <vector>

#include "ringbus/cycle/fabric/hub.h"

namespace carousel::ringbus::cycle {

/// One medium for all: moves one packet at a time from any resource to any other. Resources take turns; a resource
/// whose packet would find no place at its next stop is passed over.
class Bus final : public Hub {
 public:
  /// Ports by resource.
  Bus(const Topology& topology, std::span<const Packet> packets, std::vector<InPort> in, std::vector<OutPort> out);

  Cycle next() const override;
  void run(Cycle end) override;
  std::string describe() const override { return ""; }

 private:
  void move_one(Cycle now);

  const Topology& topology_;
  std::span<const Packet> packets_;
  std::size_t turn_ = 0;
  Cycle now_ = 0, free_at_ = 0;
};

}  // namespace carousel::ringbus::cycle
