#pragma once

#include <string>

#include "ringbus/cycle/fabric/ports.h"
#include "ringbus/cycle/machine/cycle_machine.h"
#include "ringbus/cycle/time/agent.h"

namespace carousel::ringbus::cycle {

/// One medium for all: moves one packet at a time from any resource to any other. Resources take turns; one whose
/// packet would find no place at its next stop is passed over.
class Bus final : public Agent {
 public:
  /// Ports by resource.
  Bus(CycleMachine& machine, std::vector<InPort> in, std::vector<OutPort> out);

  Cycle next() const override;
  void run(Cycle end) override;
  std::string describe() const override { return ""; }

  const std::vector<OutPort>& out() const { return out_; }

 private:
  void move_one(Cycle now);

  CycleMachine& machine_;
  std::vector<InPort> in_;
  std::vector<OutPort> out_;
  std::size_t turn_ = 0;
  Cycle now_ = 0, free_at_ = 0;
};

}  // namespace carousel::ringbus::cycle
