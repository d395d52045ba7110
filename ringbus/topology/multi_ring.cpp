#include "ringbus/topology/rounds.h"
#include "ringbus/topology/shapes.h"

namespace carousel::ringbus {

/// `topology.rings` rings side by side, all in the same direction.
TopologyPlan plan_multi_ring(const TopologyConfig& config) {
  const std::vector<std::vector<ResourceId>> rings(static_cast<std::size_t>(config.rings), round_in_steps(config, 1));
  return plan_of_rounds(config, rings);
}

}  // namespace carousel::ringbus
