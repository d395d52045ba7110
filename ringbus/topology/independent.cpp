#include "ringbus/topology/rounds.h"
#include "ringbus/topology/shapes.h"

namespace carousel::ringbus {

/// Every resource traces its own rays: there are no packets, and no links for them.
TopologyPlan plan_independent(const TopologyConfig& config) {
  TopologyPlan plan;
  plan.successors = {round_in_steps(config, 1)};
  plan.verdict = {false, "independent: every resource traces its own rays, there are no packets"};
  return plan;
}

}  // namespace carousel::ringbus
