#include <algorithm>

#include "ringbus/topology/rounds.h"
#include "ringbus/topology/shapes.h"

namespace carousel::ringbus {

/// The resources of a group form a line from the bridge of their group and back to it, and the bridges form a ring. A
/// packet goes through the rest of its own group, then round the bridges and into the groups that want it, and at last
/// into its own group again.
TopologyPlan plan_hierarchical(const TopologyConfig& config) {
  const std::uint32_t resources = static_cast<std::uint32_t>(config.resources);
  const std::uint32_t groups = std::min(static_cast<std::uint32_t>(config.groups), resources);
  const auto first_of = [&](std::uint32_t group) { return (group * resources + groups - 1) / groups; };
  const std::int64_t latency = config.link.latency_cycles;
  TopologyPlan plan;
  plan.successors.resize(1);
  plan.hubs.assign(groups, TopologyPlan::Hub::kBridge);
  for (std::uint32_t g = 0; g < groups; ++g) {
    const ResourceId bridge(resources + g), first(first_of(g)), last(first_of(g + 1) - 1);
    plan.groups.push_back({first, last});
    plan.wires.push_back({bridge, first, 0, latency});
    for (std::uint32_t r = first.value; r <= last.value; ++r) {
      const ResourceId next = ResourceId(r) == last ? bridge : ResourceId(r + 1);
      plan.successors[0].push_back(next);
      plan.wires.push_back({ResourceId(r), next, 0, latency});
    }
    if (groups > 1) plan.wires.push_back({bridge, ResourceId(resources + (g + 1) % groups), 1, latency});
  }
  plan.packets_in_flight = packets_in_flight(config);
  plan.verdict = {false,
                  "bridges: a bridge has room for all packets there are, so every line and the ring of bridges can "
                  "always move on"};
  return plan;
}

}  // namespace carousel::ringbus
