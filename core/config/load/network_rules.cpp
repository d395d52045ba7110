#include "core/config/load/network_rules.h"

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/config/graph/lane_rings.h"
#include "core/config/not_built.h"

namespace carousel::config {

namespace {

bool is_built(TopologyShape shape) {
  return !engines_with("topology.shape", enum_name(shape)).empty();
}

/// "a, b or c"
std::string shapes_with_traffic() {
  std::string out;
  for (const auto& [shape, name] : kEnumNames<TopologyShape>)
    if (properties_of(shape).carries_traffic) out += (out.empty() ? "" : ", ") + std::string(name);
  if (const std::size_t last = out.rfind(", "); last != std::string::npos) out.replace(last, 2, " or ");
  return out;
}

class NetworkRules {
 public:
  NetworkRules(const Config& config, bool force, const RuleBreach& breach)
      : c(config), force_(force), breach_(breach) {}

  void check() {
    parts_are_not_more_than_resources();
    traffic_has_a_network();
    central_is_one_unit();
    banks_are_read_together();
    flow_that_can_deadlock();
    bubble_needs_two_places();
    direct_wires_go_to_owners();
    overrides_name_resources();
    own_rays_come_last_where_packets_go_round();
    results_travel();
    children_are_single_shapes();
    blocks_of_memory_gather_rays();
    windows_have_queues();
    faults_have_a_place();
  }

 private:
  bool cycle() const { return c.engine.kind == EngineKind::kCycle; }

  /// More rings than resources would be wires without work, and groups without a resource cannot be made. One resource
  /// has no links, whatever the shape.
  void parts_are_not_more_than_resources() {
    const std::int64_t resources = c.topology.resources;
    const auto check = [&](TopologyShape shape, const char* key, std::int64_t parts) {
      if (resources > 1 && c.topology.shape == shape && parts > resources)
        breach_(key, fmt::format("expected at most topology.resources = {}, found {}", resources, parts));
    };
    check(TopologyShape::kMultiRing, "topology.rings", c.topology.rings);
    check(TopologyShape::kHierarchical, "topology.groups", c.topology.groups);
  }

  void traffic_has_a_network() {
    if (c.workload.kind != WorkloadConfig::Kind::kTraffic) return;
    if (!cycle()) breach_("engine.kind", "workload: traffic runs in virtual time; expected cycle, found native");
    if (!properties_of(c.topology.shape).carries_traffic && is_built(c.topology.shape))
      breach_("topology.shape", fmt::format("there is no traffic on {}; expected {}", enum_name(c.topology.shape),
                                            shapes_with_traffic()));
    if (c.verify != Verify::kNone)
      breach_("verify", fmt::format("traffic has no hits to verify; expected none, found {}", enum_name(c.verify)));
    const TrafficConfig& traffic = c.workload.traffic;
    if (c.topology.shape == TopologyShape::kGraph && !config::keeps_lanes(c.topology) &&
        traffic.source_queues != TrafficConfig::SourceQueues::kShared)
      breach_("workload.traffic.source_queues",
              fmt::format("at a node of a graph the source is one queue; expected shared, or topology.channels: none "
                          "where it has rings; found {}",
                          enum_name(traffic.source_queues)));
    if (c.topology.shape == TopologyShape::kHierarchical && c.topology.channels == ChannelRule::kNone)
      breach_("topology.channels",
              "packets change from line to line at the bridges of a hierarchical network; expected any, dateline or "
              "hops, found none");
    if (traffic.pattern == TrafficConfig::Pattern::kHotspot && traffic.hotspot >= c.topology.resources)
      breach_("workload.traffic.hotspot",
              fmt::format("expected a resource from 0 to {}, found {}", c.topology.resources - 1, traffic.hotspot));
    // There is at least one cycle without a packet between two bursts.
    const double burst = static_cast<double>(traffic.burst_packets), most = burst / (burst + 1);
    if (traffic.pattern == TrafficConfig::Pattern::kBursty && traffic.rate > most)
      breach_("workload.traffic.rate",
              fmt::format("bursts of {} packets make at most {:.4g} packets per cycle, found {}", traffic.burst_packets,
                          most, traffic.rate));
  }

  /// US 9633468: one collection buffer, and for each cell, or each tester behind the distributor, the rays of its own
  /// places.
  void central_is_one_unit() {
    if (!cycle() || !is_central(c.topology)) return;
    const bool cells = has_cells(c);
    if (c.topology.shape == TopologyShape::kCentral && c.topology.resources != 1)
      breach_("topology.resources",
              fmt::format("a central machine is one unit, with {}; expected 1, found {}",
                          cells ? "testers.simd.lanes cells" : "testers.distributor.testers testers",
                          c.topology.resources));
    const char* one = cells ? "a test cell holds a ray" : "a tester tests one ray at a time";
    if (cells && c.testers.simd.map != TestersConfig::Simd::Map::kRays)
      breach_("testers.simd.map", fmt::format("{}; expected rays, found shapes", one));
    if (c.collections.traversal == Traversal::kTreelet)
      breach_("collections.traversal",
              fmt::format("{} test the rays of a collection side by side; expected spread or ordered, found treelet",
                          cells ? "test cells" : "testers"));
    if (c.bundles.size > 0) breach_("bundles.size", fmt::format("{}; expected 0, found {}", one, c.bundles.size));
    if (!cells) testers_have_their_own_memory(one);
  }

  void testers_have_their_own_memory(const char* one) {
    if (c.testers.simd.lanes > 1)
      breach_("testers.simd.lanes", fmt::format("{}; expected 1, found {}", one, c.testers.simd.lanes));
    const auto reads = [&](const char* key, std::int64_t found) {
      if (found > 0)
        breach_(key,
                fmt::format("each tester reads a record a cycle from its own ray memory; expected 0, found {}", found));
    };
    reads("rays.reads_per_cycle", c.rays.reads_per_cycle);
    reads("rays.banks", c.rays.banks);
    if (has_own(c.topology)) breach_("topology.overrides", "all testers behind a distributor are equal; expected none");
  }

  void banks_are_read_together() {
    if (!cycle() || c.rays.banks == 0) return;
    if (c.rays.reads_per_cycle > 0)
      breach_("rays.reads_per_cycle", fmt::format("each bank has a port of its own; expected 0, or rays.banks: 0; "
                                                  "found {}",
                                                  c.rays.reads_per_cycle));
    if (!properties_of(c.topology).has_packets || c.collections.traversal == Traversal::kTreelet || c.bundles.size > 0)
      breach_("rays.banks", fmt::format("banks are modelled where the rays of a packet are read for one test: not with "
                                        "independent, treelet or bundles; expected 0, found {}",
                                        c.rays.banks));
  }

  void flow_that_can_deadlock() {
    if (c.topology.flow == Flow::kNone && !force_)
      breach_("topology.flow", "none lets the links fill up and stop; expected credits or bubble, or --force");
  }

  void bubble_needs_two_places() {
    if (c.topology.flow == Flow::kBubble && c.topology.link.depth < 2)
      breach_("topology.link.depth",
              fmt::format("flow: bubble keeps one place of a link free; expected at least 2, found {}",
                          c.topology.link.depth));
  }

  // A round through all resources uses the wires to neighbours alone.
  void direct_wires_go_to_owners() {
    if (c.topology.shape != TopologyShape::kPointToPoint || c.topology.visit != Visit::kAll) return;
    if (c.topology.resources <= 2 || c.workload.kind == WorkloadConfig::Kind::kTraffic) return;
    breach_("topology.visit",
            "point_to_point sends a packet straight to the owners of its rays, and to visit all would be a ring with "
            "idle wires; expected owners, or topology.shape: ring; found all");
  }

  void overrides_name_resources() {
    std::map<std::int64_t, std::string> seen;
    for_each_own(c.topology, [&](const OwnOf& one) {
      if (one.override == nullptr)
        for (std::int64_t r = one.first; r < one.first + one.count; ++r) seen.emplace(r, own_place(one));
      own_testers_agree(one);
    });
    const bool graph = c.topology.shape == TopologyShape::kGraph;
    for (std::size_t i = 0; i < c.topology.overrides.size(); ++i) {
      const ResourceOverride& one = c.topology.overrides[i];
      const std::string entry = fmt::format("topology.overrides.{}", i), key = entry + ".resource";
      if (one.resource.has_value() != one.nodes.empty())
        breach_(entry, "expected the key 'resource', or 'nodes' for those of a graph");
      if (!one.nodes.empty() && !graph) breach_(entry + ".nodes", "only a graph has names; expected resource");
      if (one.resource >= c.topology.resources)
        breach_(key,
                fmt::format("expected a resource from 0 to {}, found {}", c.topology.resources - 1, *one.resource));
      const auto taken = [&](std::int64_t resource, const std::string& at) {
        const auto [known, added] = seen.emplace(resource, entry);
        if (added) return false;
        const bool by_node = known->second.starts_with("topology.nodes");
        breach_(at, by_node ? fmt::format("resource {} has numbers of its own in {} already; expected one of the two "
                                          "places",
                                          resource, known->second)
                            : fmt::format("resource {} has an override already", resource));
        return true;
      };
      if (one.resource && *one.resource < c.topology.resources) taken(*one.resource, key);
      for (const std::int64_t resource : one.named)
        if (taken(resource, entry + ".nodes")) break;
    }
  }

  /// Some keys of testers are the same in all resources.
  void own_testers_agree(const OwnOf& one) {
    if (one.testers == nullptr) return;
    const std::string place = own_place(one) + ".testers.";
    if (one.testers->any_hit != c.testers.any_hit)
      breach_(place + "any_hit", fmt::format("all resources have the same any-hit calls; expected {}, found {}",
                                             enum_name(c.testers.any_hit), enum_name(one.testers->any_hit)));
    if (one.testers->own_rays != c.testers.own_rays)
      breach_(place + "own_rays", fmt::format("all resources test their own rays at the same time; expected {}, found "
                                              "{}",
                                              enum_name(c.testers.own_rays), enum_name(one.testers->own_rays)));
  }

  void own_rays_come_last_where_packets_go_round() {
    if (c.testers.own_rays != TestersConfig::OwnRays::kAfter) return;
    if (!properties_of(c.topology).has_packets)
      breach_("testers.own_rays", fmt::format("{} has no packets that come back; expected before, found after",
                                              without_packets(c.topology)));
    if (cycle() && c.memory.fetch == MemoryConfig::Fetch::kMulticast)
      breach_("testers.own_rays",
              "an issuer multicasts the shapes that it fetches before its packet leaves, for its own rays; expected "
              "before, or memory.fetch: resource; found after");
  }

  void results_travel() {
    if (c.packets.results == PacketResults::kMask) return;
    const std::string_view found = enum_name(c.packets.results);
    if (!properties_of(c.topology).has_packets)
      breach_("packets.results", fmt::format("{} has no packets that bring results; expected mask, found {}",
                                             without_packets(c.topology), found));
    if (c.packets.results == PacketResults::kPerShape && c.collections.traversal == Traversal::kOrdered)
      breach_("packets.results",
              "traversal: ordered has one result for a whole strip, the next node; expected mask, message or "
              "implied_order, found per_shape");
  }

  void blocks_of_memory_gather_rays() {
    if (c.collections.key == CollectionKey::kNode) return;
    const auto refuse = [&](bool wrong, const char* key, const std::string& message) {
      if (wrong) breach_(key, message);
    };
    refuse(!properties_of(c.topology).has_packets, "collections.key",
           fmt::format("{} has no collections; expected node, found block", without_packets(c.topology)));
    refuse(c.collections.traversal != Traversal::kOrdered, "collections.traversal",
           fmt::format("a ray that is in several collections has no node of its own in a block; expected ordered, or "
                       "collections.key: node; found {}",
                       enum_name(c.collections.traversal)));
    refuse(c.packets.carry == PacketCarry::kData, "packets.carry",
           "blocks of memory are not carried; expected reference, or collections.key: node; found data");
    refuse(c.bvh.levels > 2, "bvh.levels",
           fmt::format("within groups of instances rays gather at nodes; expected 2, or collections.key: node; "
                       "found {}",
                       c.bvh.levels));
    const auto one_ray = [&](const std::string& key, std::int64_t lanes) {
      refuse(lanes > 1, key.c_str(),
             fmt::format("the rays of a vector meet one shape at a time, and those of a block are at several nodes; "
                         "expected 1, or collections.key: node; found {}",
                         lanes));
    };
    one_ray("testers.simd.lanes", c.testers.simd.lanes);
    for_each_own(c.topology, [&](const OwnOf& one) {
      if (one.testers != nullptr) one_ray(own_place(one) + ".testers.simd.lanes", one.testers->simd.lanes);
    });
  }

  void children_are_single_shapes() {
    if (c.packets.made_per != MadePer::kChild || c.packets.shapes == PacketShapes::kSingle) return;
    breach_("packets.made_per",
            "a packet of a child tests one shape; expected parent, or packets.shapes: single; found child");
  }

  void windows_have_queues() {
    if (properties_of(c.topology).has_packets) return;
    const auto check = [&](const std::string& key, std::int64_t window) {
      if (window > 1)
        breach_(key, fmt::format("{} has no input queues; expected 1, found {}", without_packets(c.topology), window));
    };
    check("testers.window", c.testers.window);
    for_each_own(c.topology, [&](const OwnOf& one) {
      if (one.testers != nullptr) check(own_place(one) + ".testers.window", one.testers->window);
    });
  }

  void faults_have_a_place() {
    const FaultsConfig::Resource& r = c.faults.resource;
    const bool resource = r.kind != FaultsConfig::Resource::Kind::kNone;
    if (resource && r.number >= c.topology.resources)
      breach_("faults.resource.number",
              fmt::format("expected a resource from 0 to {}, found {}", c.topology.resources - 1, r.number));
    if (c.workload.kind == WorkloadConfig::Kind::kTraffic && (resource || c.faults.links.any()))
      breach_("faults", "there are no faults in traffic; expected none, or workload: rays");
    if (resource && !properties_of(c.topology).has_packets)
      breach_("faults.resource.kind", "independent resources have no faults; expected none");
    if (c.faults.links.any()) faulty_links_carry_packets();
    if (cycle() && r.kind == FaultsConfig::Resource::Kind::kSlow && r.after_rays > 0)
      breach_("faults.resource.after_rays",
              fmt::format("under virtual time a slow resource is slow from the beginning; expected 0, found {}",
                          r.after_rays));
    if (r.kind == FaultsConfig::Resource::Kind::kStop) stop_leaves_a_resource();
    if (c.faults.compare && !cycle())
      breach_("faults.compare",
              "on the wall clock two runs differ by more than faults cost; expected false, or engine.kind: cycle");
    // The engine takes a machine that does nothing for ten seconds for one that is stuck.
    if (!cycle() && r.kind == FaultsConfig::Resource::Kind::kPause && r.cycles / c.engine.clock_mhz > 5'000'000)
      breach_("faults.resource.cycles",
              fmt::format("the native engine pauses at most 5 seconds; expected at most {} at {} MHz, found {}",
                          5'000'000 * c.engine.clock_mhz, c.engine.clock_mhz, r.cycles));
  }

  /// A fault of a link that no packet crosses would never happen.
  void faulty_links_carry_packets() {
    constexpr std::string_view otherwise = "; expected no faults of links, or ";
    if (!properties_of(c.topology).has_packets)
      breach_("faults.links",
              c.topology.shape == TopologyShape::kGraph
                  ? fmt::format("no link of this graph carries packets, and others have no faults{}"
                                "topology.trace: packets",
                                otherwise)
                  : fmt::format("independent resources have no links{}another topology.shape", otherwise));
    else if (c.topology.resources == 1)
      breach_("faults.links", fmt::format("one resource has no links{}more topology.resources", otherwise));
    else if (c.collections.home == Home::kLocal)
      breach_("faults.links", fmt::format("with collections.home: local no packet travels{}another home", otherwise));
  }

  void stop_leaves_a_resource() {
    if (c.topology.resources < 2)
      breach_("topology.resources", "when a resource stops, another has to continue; expected at least 2, found 1");
  }

  const Config& c;
  bool force_;
  const RuleBreach& breach_;
};

}  // namespace

void check_network(const Config& config, bool force, const RuleBreach& breach) {
  NetworkRules(config, force, breach).check();
}

}  // namespace carousel::config
