#include "ringbus/topology/rounds.h"
#include "ringbus/topology/shapes.h"

namespace carousel::ringbus {

/// Every resource traces its own rays: there are no links and no packets.
TopologyPlan plan_independent(const TopologyConfig& config) {
  TopologyPlan plan;
  plan.successors = {round_in_steps(config, 1)};
  plan.verdict = {false, "independent: every resource traces its own rays, there are no links"};
  return plan;
}

}  // namespace carousel::ringbus
