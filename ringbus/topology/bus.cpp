#include <algorithm>

#include "ringbus/topology/rounds.h"
#include "ringbus/topology/shapes.h"

namespace carousel::ringbus {

/// One medium that all resources share and hear. The way to the bus takes half of the link's latency, the way from it
/// the other half, each at least a cycle.
TopologyPlan plan_bus(const TopologyConfig& config) {
  const ResourceId bus(static_cast<std::uint32_t>(config.resources));
  const std::int64_t there = std::max<std::int64_t>(1, config.link.latency_cycles / 2);
  const std::int64_t back = std::max<std::int64_t>(1, config.link.latency_cycles - there);
  TopologyPlan plan;
  plan.successors = {round_in_steps(config, 1)};
  for (std::uint32_t r = 0; r < bus.value; ++r) {
    plan.wires.push_back({ResourceId(r), bus, 0, there});
    plan.wires.push_back({bus, ResourceId(r), 0, back});
  }
  plan.direct = plan.room_for_all = true;
  plan.hubs = {TopologyPlan::Hub::kBus};
  plan.packets_in_flight = packets_in_flight(config);
  plan.verdict =
      config.flow == Flow::kNone
          ? verdict_of_flow(config)
          : DeadlockVerdict{false,
                            "bus: every resource has egress places for all packets there are, so a packet that the "
                            "bus brings is always taken in"};
  return plan;
}

}  // namespace carousel::ringbus
