#pragma once

#include <array>
#include <string>

#include "ringbus/cycle/fabric/ports.h"
#include "ringbus/cycle/machine/cycle_machine.h"
#include "ringbus/cycle/time/agent.h"

namespace carousel::ringbus::cycle {

/// Where a group of a hierarchical topology meets the ring of groups. It has room for every packet there is, so
/// that neither ring ever waits for the other: what arrives is taken, and no circle of full queues can close.
class Bridge final : public Agent {
 public:
  /// Ports: 0 of the group, 1 of the ring of bridges (which is missing when there is one group).
  Bridge(std::uint32_t group, CycleMachine& machine, std::vector<InPort> in, std::vector<OutPort> out);

  Cycle next() const override;
  void run(Cycle end) override;
  std::string describe() const override;

  const std::vector<OutPort>& out() const { return out_; }

 private:
  void step(Cycle now);
  void pass_on(Token token, bool from_group, Cycle now);

  std::uint32_t group_;
  CycleMachine& machine_;
  std::vector<InPort> in_;
  std::vector<OutPort> out_;
  Cycle now_ = 0;
};

}  // namespace carousel::ringbus::cycle
