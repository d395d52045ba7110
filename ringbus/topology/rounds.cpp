#include "ringbus/topology/rounds.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace carousel::ringbus {

std::vector<ResourceId> round_in_steps(const TopologyConfig& config, std::int64_t step) {
  std::vector<ResourceId> round;
  for (std::int64_t r = 0; r < config.resources; ++r)
    round.push_back(ResourceId(static_cast<std::uint32_t>((r + step) % config.resources)));
  return round;
}

TopologyPlan plan_of_rounds(const TopologyConfig& config, std::vector<std::vector<ResourceId>> successors) {
  TopologyPlan plan;
  plan.successors = std::move(successors);
  const std::uint16_t directions = static_cast<std::uint16_t>(plan.successors.size());
  for (std::uint16_t d = 0; d < directions; ++d) {
    ResourceId at(0);
    for (std::int64_t i = 0; i < config.resources; ++i) {
      const ResourceId next = plan.successors[d][at.value];
      plan.wires.push_back({at, next, d, config.link.latency_cycles});
      at = next;
    }
  }
  plan.packets_in_flight = packets_in_flight(config);
  plan.verdict = verdict_of_flow(config);
  for (std::uint16_t d = 0; d < directions; ++d) plan.ack_directions.push_back(d);
  return plan;
}

std::uint32_t packets_in_flight(const TopologyConfig& config) {
  const std::uint32_t depth = static_cast<std::uint32_t>(config.link.depth);
  const std::uint32_t resources = static_cast<std::uint32_t>(config.resources);
  switch (config.flow) {
    // R resources with `depth` packets each against R links of `depth` places and an egress place at each resource:
    // one place is always free, so some packet can always move.
    case Flow::kCredits:
      return depth;
    // Any number is safe. More than the links hold would be of no use.
    case Flow::kBubble:
      return std::min(depth * resources, 256u);
    // Enough to fill every link and every egress queue.
    case Flow::kNone:
      return depth + 8;
  }
  return depth;
}

DeadlockVerdict verdict_of_flow(const TopologyConfig& config) {
  const std::int64_t resources = config.resources, depth = config.link.depth;
  switch (config.flow) {
    case Flow::kCredits:
      return {false,
              fmt::format("credits: {0} resources with at most {1} packets each put {2} packets on a ring of {3} "
                          "places ({0} links of depth {1} and one egress place at each resource), so one place is "
                          "always free",
                          resources, depth, resources * depth, resources * (depth + 1))};
    case Flow::kBubble:
      return {false,
              "bubble: a packet enters only where two places of the link are free, so one stays free on the ring"};
    case Flow::kNone:
      return {true,
              fmt::format("nothing bounds the packets on the way: {} resources may put {} each on links of depth {}; "
                          "when every link and every egress queue is full, each waits for the next one round the ring",
                          resources, packets_in_flight(config), depth)};
  }
  return {true, "unknown flow control"};
}

}  // namespace carousel::ringbus
