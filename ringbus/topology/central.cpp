#include "ringbus/topology/rounds.h"
#include "ringbus/topology/shapes.h"

namespace carousel::ringbus {

/// One unit holds all rays and collections and tests all packets: there are no links.
TopologyPlan plan_central(const TopologyConfig& config) {
  TopologyPlan plan;
  plan.successors = {round_in_steps(config, 1)};
  plan.verdict = {false, "central: packets are tested where they are issued, there are no links"};
  return plan;
}

}  // namespace carousel::ringbus
