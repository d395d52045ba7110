#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/config/load/network_rules.h"

namespace carousel::config {

namespace {

constexpr std::int64_t kMostWorkers = 256;

/// The workers of all pools, and those of each.
void check_workers(const Config& config, const DrawnPools& drawn, const RuleBreach& breach) {
  const std::int64_t all = shader_workers(config);
  if (drawn.silent == 0) {
    if (config.shading.workers)
      breach("shading.workers", fmt::format("each node of the kind shading names its workers; expected auto, found {}",
                                            *config.shading.workers));
    if (all > kMostWorkers)
      breach("topology.nodes",
             fmt::format("all pools together have {} workers; expected at most {}", all, kMostWorkers));
    return;
  }
  if (all - drawn.workers >= drawn.silent) return;
  breach(
      "topology.nodes",
      fmt::format("of shading.workers, {}, pools that name theirs have {}, and {} the rest; expected a worker at "
                  "least for each, or `workers` at all pools",
                  all, drawn.workers, drawn.silent == 1 ? "1 pool has" : fmt::format("{} pools share", drawn.silent)));
}

/// Refuses what a machine has once, beside or behind its only pool.
void check_single(const Config& config, const RuleBreach& breach) {
  const auto refuse = [&](const char* key, bool found, std::string_view expected) {
    if (found)
      breach(key, fmt::format("several nodes of the kind shading do not have this yet; expected {}, or one such node",
                              expected));
  };
  const MemoryConfig& memory = config.memory;
  using Free = MemoryConfig::ShadingData;
  refuse("rays.placement", config.rays.placement == Placement::kFirstTaker, "balanced, found first_taker");
  refuse("rays.placement", config.rays.placement == Placement::kAddressed, "balanced, found addressed");
  refuse("shading.program.default", config.shading.program.any(), "constant");
  refuse("memory.ray_records", memory.ray_records != MemoryConfig::RayRecords::kResource, "resource, found master");
  refuse("memory.path_state", memory.path_state != Free::kFree, "free, found memory");
  refuse("memory.film", memory.film != Free::kFree, "free, found memory");
  refuse("memory.sky_map", memory.sky_map != Free::kFree && config.scene.sky && !config.scene.sky->file.empty(),
         "free, found memory");
  refuse("memory.surfaces", memory.surfaces != Free::kFree, "free, found memory");
  refuse("raster.time", config.primary == Primary::kRaster && config.raster.time != RasterConfig::Time::kFree,
         "free, found cycles");
  refuse("faults.resource.kind", config.faults.resource.kind == FaultsConfig::Resource::Kind::kStop,
         "no resource that stops");
}

}  // namespace

void check_pools(const Config& config, const RuleBreach& breach) {
  const DrawnPools drawn = drawn_pools(config.topology);
  if (drawn.pools == 0) return;
  check_workers(config, drawn, breach);
  const bool cycle = config.engine.kind == EngineKind::kCycle;
  if (cycle && drawn.pools > 1) check_single(config, breach);
  const std::vector<GraphLink>& links = config.topology.links;
  for (std::size_t i = 0; i < links.size() && !cycle; ++i)
    if (links[i].queue && std::ranges::count(links[i].carries, Carried::kPackets) == 0)
      breach(fmt::format("topology.links.{}.queue", i),
             "in the native engine rays go to shading by queues of their own; expected none at a link without packets");
}

}  // namespace carousel::config
