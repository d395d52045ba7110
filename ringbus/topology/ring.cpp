#include "ringbus/topology/rounds.h"
#include "ringbus/topology/shapes.h"

namespace carousel::ringbus {

/// One link from each resource to the next one.
TopologyPlan plan_ring(const TopologyConfig& config) {
  return plan_of_rounds(config, {round_in_steps(config, 1)});
}

}  // namespace carousel::ringbus
