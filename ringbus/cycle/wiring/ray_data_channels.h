#pragma once

#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/time/agent.h"
#include "ringbus/time/wakeup_table.h"

namespace carousel::ringbus::cycle {

/// The channels on which ray control and shading read and write data of rays and paths through one L2.
class RayDataChannels {
 public:
  SidePorts ports() {
    SidePorts side;
    side.fetch = &requests_;
    side.fetched = &answers_;
    return side;
  }
  void connect(WakeupTable& wakeups, const Agent& shading, const Agent& cache) {
    wakeups.connect(requests_, shading, cache);
    wakeups.connect(answers_, cache, shading);
  }

 private:
  Channel<FetchRequest> requests_;
  Channel<FetchAnswer> answers_;
};

}  // namespace carousel::ringbus::cycle
