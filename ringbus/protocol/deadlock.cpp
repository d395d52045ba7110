#include "ringbus/protocol/deadlock.h"

#include <utility>

#include <fmt/format.h>

#include "ringbus/resource/storage_rule.h"
#include "ringbus/resource/traversal/make_traversal.h"
#include "ringbus/topology/drawn_shape.h"
#include "ringbus/topology/graph_facts.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus {

DeadlockVerdict deadlock_verdict(const TopologyConfig& config) {
  return Topology(config).verdict();
}

DeadlockVerdict deadlock_verdict(const Config& config) {
  const bool traffic = config.workload.kind == WorkloadConfig::Kind::kTraffic;
  if (traffic && config.topology.shape == TopologyShape::kGraph) return traffic_verdict(config.topology);
  if (traffic && config.topology.shape == TopologyShape::kHierarchical && config.topology.resources > 1)
    return traffic_verdict(draw_shape(config.topology).config);
  return deadlock_verdict(config.topology);
}

std::int64_t minimum_capacity(const Config& config, int width, int max_depth) {
  if (config.collections.when_full == WhenFull::kSpill || !Topology(config.topology).has_packets()) return 0;
  if (one_collection_a_ray(config.collections.traversal)) return 1;
  const std::int64_t reserve = reserve_blocks(config.collections, config.packets, config.bundles, width, max_depth);
  const std::int64_t children = most_blocks(config.packets, config.bundles, width);
  return 2 * (reserve + children + 1) * config.packets.rays;
}

std::vector<ConfigIssue> check_storage(const Config& config, const accel::Accel& accel) {
  const std::int64_t needed = minimum_capacity(config, accel.most_ways(), accel.levels());
  std::vector<ConfigIssue> issues;
  const auto check = [&](std::string key, std::int64_t found) {
    if (found >= needed) return;
    ConfigIssue& issue = issues.emplace_back();
    issue.key_path = std::move(key);
    issue.message = fmt::format(
        "expected at least {} ray IDs with when_full: reserve ({}), found {}; or use when_full: spill", needed,
        fmt::format("blocks of packets.rays = {}, nodes {} wide, {} strips deep{}", config.packets.rays, accel.width,
                    accel.max_depth,
                    config.bundles.size > 0 ? fmt::format(", bundles of {} rays", config.bundles.size) : ""),
        found);
  };
  check("collections.capacity", config.collections.capacity);
  for_each_own(config.topology, [&](const OwnOf& one) {
    if (one.keys->capacity) check(own_place(one) + ".capacity", *one.keys->capacity);
  });
  return issues;
}

}  // namespace carousel::ringbus
