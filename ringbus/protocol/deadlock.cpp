#include "ringbus/protocol/deadlock.h"

#include <fmt/format.h>

#include "ringbus/resource/admission.h"
#include "ringbus/resource/traversal/make_traversal.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus {

DeadlockVerdict deadlock_verdict(const TopologyConfig& config) {
  const std::int64_t resources = config.resources, depth = config.link.depth;
  if (resources == 1) return {false, "one resource: packets are tested where they are issued, there are no links"};
  if (config.shape == TopologyShape::kIndependent)
    return {false, "independent: every resource traces its own rays, there are no links"};
  if (config.shape == TopologyShape::kPointToPoint && config.flow != Flow::kNone)
    return {false, fmt::format("credits: at most {} packets a resource are on the way, and every resource has places "
                               "in hand for all {} of them, so an arriving packet is always taken in",
                               packets_in_flight(config), packets_in_flight(config) * resources)};
  if (config.shape == TopologyShape::kBus && config.flow != Flow::kNone)
    return {
        false,
        "bus: every resource has places in hand for all packets there are, so what the bus brings is always taken in"};
  if (config.shape == TopologyShape::kHierarchical)
    return {false,
            "bridges: a bridge has room for all packets there are, so every line and the ring of bridges can always "
            "move on"};
  switch (config.flow) {
    case Flow::kCredits:
      return {false,
              fmt::format("credits: {0} resources with at most {1} packets each put {2} packets on a ring of {3} "
                          "places ({0} links of depth {1} and one in hand at each resource), so one place is "
                          "always free",
                          resources, depth, resources * depth, resources * (depth + 1))};
    case Flow::kBubble:
      return {false,
              "bubble: a packet enters only where two places of the link are free, so one stays free on the ring"};
    case Flow::kNone:
      return {true,
              fmt::format("nothing bounds the packets on the way: {} resources may put {} each on links of depth {}; "
                          "when every link and every hand is full, each waits for the next one round the ring",
                          resources, packets_in_flight(config), depth)};
  }
  return {true, "unknown flow control"};
}

std::int64_t minimum_capacity(const Config& config, int width, int max_depth) {
  if (config.collections.when_full == WhenFull::kSpill || config.topology.shape == TopologyShape::kIndependent)
    return 0;
  if (one_collection_a_ray(config.collections.traversal)) return config.packets.rays;
  const std::int64_t reserve = reserve_blocks(config.collections, config.bundles, width, max_depth);
  const std::int64_t children = width * std::max<std::int64_t>(1, config.bundles.size);
  return 2 * (reserve + children + 1) * config.packets.rays;
}

std::vector<ConfigIssue> check_storage(const Config& config, const accel::Accel& accel) {
  const std::int64_t needed = minimum_capacity(config, accel.width, accel.max_depth);
  if (config.collections.capacity >= needed) return {};
  const bool ordered = one_collection_a_ray(config.collections.traversal);
  ConfigIssue issue;
  issue.key_path = "collections.capacity";
  issue.message = fmt::format(
      "expected at least {} ray IDs with when_full: reserve ({}), found {}; or use when_full: spill", needed,
      ordered ? fmt::format("one block of packets.rays = {}", config.packets.rays)
              : fmt::format("blocks of packets.rays = {}, nodes {} wide, {} strips deep{}", config.packets.rays,
                            accel.width, accel.max_depth,
                            config.bundles.size > 0 ? fmt::format(", bundles of {} rays", config.bundles.size) : ""),
      config.collections.capacity);
  return {issue};
}

}  // namespace carousel::ringbus
