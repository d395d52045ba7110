#include "app/versus/twin.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/config/load/validate.h"
#include "core/config/own_sections.h"
#include "core/system/error.h"

namespace carousel::app {

namespace {

constexpr std::int64_t kLanes = 32;

[[noreturn]] void no_twin(const LocatedConfig& located, const std::string& key, const std::string& why) {
  throw ConfigError({{located.positions.find(key), key, why}});
}

/// A resource's testers: `testers` times the units, a unit for each lane of vector units, and warps for all of its
/// rays.
TestersConfig in_warps(TestersConfig testers, std::int64_t times, std::int64_t slots) {
  for (const auto [kind, units] : testers.units) units.units = units.units * times * testers.simd.lanes;
  testers.simd = {};
  testers.distributor = {};
  testers.bundle_blocks = TestersConfig{}.bundle_blocks;
  if (testers.simt.warp == 0) {
    testers.simt.warp = std::min(kLanes, slots);
    testers.simt.warps = std::min<std::int64_t>(1024, std::max<std::int64_t>(1, slots / testers.simt.warp));
  }
  return testers;
}

/// The resources that differ from the rest, each by its number; what they have for packets and collections is left out.
std::vector<ResourceOverride> overrides_of(const Config& c) {
  std::vector<ResourceOverride> out;
  for (std::int64_t r = 0; r < ray_owners(c.topology); ++r) {
    ResourceOverride own;
    own.resource = r;
    bool differs = false;
    for_each_own(c.topology, [&](const OwnOf& one) {
      if (!one.is_about(r)) return;
      differs = true;
      config::for_each_own_key([&](const auto& row) {
        const std::string_view path = row.path;
        const bool of_packets = path.starts_with("packets.") || path.starts_with("collections.");
        if (!of_packets && path != "memory.fetch_ahead" && one.keys->*row.own) own.own.*row.own = one.keys->*row.own;
      });
    });
    if (!differs) continue;
    const OwnSections sections = own_sections(c, r);
    own.testers = in_warps(sections.testers, own_testers(c), sections.rays.slots_per_resource);
    out.push_back(own);
  }
  return out;
}

/// Resources that share a cache where caches are drawn.
std::int64_t sharing_of(const Config& c) {
  std::int64_t caches = 0;
  if (c.topology.shape == TopologyShape::kGraph)
    for (const GraphNode& node : c.topology.nodes)
      if (node.kind == GraphNodeKind::kCache) caches += node.count.value_or(1);
  return caches == 0 ? c.memory.shared_by : (ray_owners(c.topology) + caches - 1) / caches;
}

}  // namespace

Config conventional_twin(const LocatedConfig& located) {
  const Config& c = located.config;
  if (c.engine.kind != EngineKind::kCycle)
    no_twin(located, "engine.kind", "machines are compared under virtual time; expected cycle, found native");
  if (c.workload.kind == WorkloadConfig::Kind::kTraffic || c.workload.kind == WorkloadConfig::Kind::kMemoryTrace)
    no_twin(located, "workload", "the conventional machine traces rays, and this workload has none; expected rays");
  if (!properties_of(c.topology.shape).has_packets && c.testers.simt.warp > 0)
    no_twin(located, "topology.shape",
            fmt::format("this machine is the conventional one itself, with warps of {}; expected another shape, or "
                        "testers.simt.warp: 0; found {}",
                        c.testers.simt.warp, enum_name(c.topology.shape)));
  Config t = c;
  t.topology = {};
  t.topology.resources = ray_owners(c.topology);
  t.topology.shape = TopologyShape::kIndependent;
  t.topology.link = c.topology.link;
  t.topology.overrides = overrides_of(c);
  t.testers = in_warps(c.testers, own_testers(c), c.rays.slots_per_resource);
  t.packets = {};
  t.packets.rays = c.packets.rays;
  t.collections = {};
  t.collections.order = c.collections.order;
  t.bundles = {};
  t.rays.banks = 0;
  if (t.rays.placement == Placement::kFirstTaker || t.rays.placement == Placement::kAddressed)
    t.rays.placement = RaysConfig{}.placement;
  const MemoryConfig usual;
  t.memory.shared_by = sharing_of(c);
  t.memory.fetch = usual.fetch;
  t.memory.fetch_ahead = usual.fetch_ahead;
  t.memory.strip_end = usual.strip_end;
  t.shading.idle_resources_shade = false;
  t.area.budget_mm2.reset();
  t.area.fit = AreaConfig{}.fit;
  if (std::vector<ConfigIssue> issues = validate_config(t, located.positions); !issues.empty()) {
    for (ConfigIssue& issue : issues) issue.message = "of the conventional twin: " + issue.message;
    throw ConfigError(std::move(issues));
  }
  return t;
}

}  // namespace carousel::app
