#include <fmt/format.h>

#include "ringbus/topology/rounds.h"
#include "ringbus/topology/shapes.h"

namespace carousel::ringbus {

/// A link from every resource to every other. A packet visits resources in the order of their numbers.
TopologyPlan plan_point_to_point(const TopologyConfig& config) {
  const std::uint32_t resources = static_cast<std::uint32_t>(config.resources);
  TopologyPlan plan;
  plan.successors = {round_in_steps(config, 1)};
  for (std::uint32_t from = 0; from < resources; ++from)
    for (std::uint32_t to = 0; to < resources; ++to)
      if (to != from) plan.wires.push_back({ResourceId(from), ResourceId(to), 0, config.link.latency_cycles});
  plan.direct = plan.room_for_all = true;
  plan.packets_in_flight = packets_in_flight(config);
  plan.verdict = config.flow == Flow::kNone
                     ? verdict_of_flow(config)
                     : DeadlockVerdict{false, fmt::format("credits: at most {} packets a resource are on the way, and "
                                                          "every resource has egress places for all {} of them, so an "
                                                          "arriving packet is always taken in",
                                                          plan.packets_in_flight, plan.packets_in_flight * resources)};
  return plan;
}

}  // namespace carousel::ringbus
