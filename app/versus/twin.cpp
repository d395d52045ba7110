#include "app/versus/twin.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/config/graph/graph.h"
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

bool has_drawn_parts(const TopologyConfig& c) {
  return std::ranges::any_of(c.nodes, [](const GraphNode& node) {
    return node.kind == GraphNodeKind::kCache || node.kind == GraphNodeKind::kMemory ||
           node.kind == GraphNodeKind::kShading;
  });
}

/// The drawing without packets, without the links that carry nothing else, and without the routers that have none left.
TopologyConfig without_packets_drawn(const Config& c) {
  const TopologyConfig plain;
  TopologyConfig t = c.topology;
  t.trace = Tracing::kStacks;
  t.form = plain.form;
  t.visit = plain.visit;
  t.flow = plain.flow;
  t.routes = plain.routes;
  t.root.clear();
  t.ways.clear();
  t.tour = plain.tour;
  t.channels = plain.channels;
  t.overrides = overrides_of(c);
  for (GraphLink& link : t.links) {
    std::erase(link.carries, Carried::kPackets);
    link.depth.reset();
  }
  std::erase_if(t.links, [](const GraphLink& link) { return link.carries.empty(); });
  for (GraphNode& node : t.nodes) {
    if (node.kind == GraphNodeKind::kPacketProcess) node.kind = GraphNodeKind::kResource;
    node.buffers.reset();
    node.forward = Forward::kHead;
    node.credit_cycles = 0;
    node.own = {};
    node.testers.reset();
  }
  std::vector<config::GraphIssue> ignored;  // validation finds them
  const config::Graph graph = config::draw_graph(t, ignored);
  std::set<std::string> linked;
  for (const config::Graph::Link& link : graph.links)
    for (const std::uint32_t end : {link.from, link.to}) linked.insert(graph.nodes[end].drawn->name);
  std::erase_if(t.nodes, [&](const GraphNode& node) {
    return (node.kind == GraphNodeKind::kRouter || node.kind == GraphNodeKind::kBus) && !linked.contains(node.name);
  });
  return t;
}

/// The twin with wires of its own in place of a network.
Config plain_twin(const Config& c) {
  Config t = c;
  t.topology = {};
  t.topology.resources = ray_owners(c.topology);
  t.topology.shape = TopologyShape::kIndependent;
  t.topology.link = c.topology.link;
  t.topology.overrides = overrides_of(c);
  if (const DrawnPools drawn = drawn_pools(c.topology); drawn.pools > 0 && drawn.silent == 0)
    t.shading.workers = drawn.workers;
  t.clocks.noc.reset();
  t.clocks.others.clear();
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
  t.area.aim = AreaConfig{}.aim;
  return t;
}

/// Puts the twin into the drawing of the machine, where that has more than packets.
void draw_twin(const LocatedConfig& located, Twin& twin) {
  const TopologyConfig& c = located.config.topology;
  if (c.shape != TopologyShape::kGraph) return;
  constexpr std::string_view not_drawn = "the twin is not drawn, and has wires of its own: ";
  if (!has_drawn_parts(c)) {
    twin.drawing = fmt::format("{}links of this machine carry packets alone", not_drawn);
    return;
  }
  if (managers_of(c) > 0) {
    twin.drawing =
        fmt::format("{}the drawing of packet processes that serve resources means nothing without packets", not_drawn);
    return;
  }
  Config drawn = twin.plain;
  drawn.topology = without_packets_drawn(located.config);
  drawn.shading.workers = located.config.shading.workers;
  drawn.memory.shared_by = located.config.memory.shared_by;
  drawn.clocks = located.config.clocks;
  std::erase_if(drawn.clocks.others, [&](const auto& clock) {
    const auto goes_by_it = [&](const auto& one) { return one.clock == clock.first; };
    return std::ranges::none_of(drawn.topology.nodes, goes_by_it) &&
           std::ranges::none_of(drawn.topology.links, goes_by_it);
  });
  if (const std::vector<ConfigIssue> issues = validate_config(drawn, located.positions); !issues.empty()) {
    twin.drawing = fmt::format("{}{}: {}", not_drawn, issues.front().key_path, issues.front().message);
    return;
  }
  twin.drawing =
      "the twin has the drawing of this machine without packets; at equal area it has wires of its own, which favours "
      "it, as a drawing has as many resources as it has";
  twin.config = std::move(drawn);
}

}  // namespace

Twin conventional_twin(const LocatedConfig& located) {
  const Config& c = located.config;
  if (c.engine.kind != EngineKind::kCycle)
    no_twin(located, "engine.kind", "machines are compared under virtual time; expected cycle, found native");
  if (c.workload.kind == WorkloadConfig::Kind::kTraffic || c.workload.kind == WorkloadConfig::Kind::kMemoryTrace)
    no_twin(located, "workload", "the conventional machine traces rays, and this workload has none; expected rays");
  if (!properties_of(c.topology).has_packets && c.testers.simt.warp > 0) {
    const bool drawn = c.topology.shape == TopologyShape::kGraph;
    no_twin(located, drawn ? "topology.trace" : "topology.shape",
            fmt::format("this machine is the conventional one itself, with warps of {}; expected {}, or "
                        "testers.simt.warp: 0; found {}",
                        c.testers.simt.warp, drawn ? "packets" : "another shape",
                        drawn ? enum_name(c.topology.trace) : enum_name(c.topology.shape)));
  }
  const Config plain = plain_twin(c);
  if (std::vector<ConfigIssue> issues = validate_config(plain, located.positions); !issues.empty()) {
    for (ConfigIssue& issue : issues) issue.message = "of the conventional twin: " + issue.message;
    throw ConfigError(std::move(issues));
  }
  Twin twin{plain, plain, ""};
  draw_twin(located, twin);
  return twin;
}

}  // namespace carousel::app
