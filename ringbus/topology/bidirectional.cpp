#include "ringbus/topology/rounds.h"
#include "ringbus/topology/shapes.h"

namespace carousel::ringbus {

/// Two rings in opposite directions. The acknowledgement of a delivery goes back the way the packet came.
TopologyPlan plan_bidirectional(const TopologyConfig& config) {
  TopologyPlan plan = plan_of_rounds(config, {round_in_steps(config, 1), round_in_steps(config, config.resources - 1)});
  plan.ack_directions = {1, 0};
  return plan;
}

}  // namespace carousel::ringbus
