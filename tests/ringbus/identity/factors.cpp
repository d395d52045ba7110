// The one list of what machines may have otherwise. The validator of the configuration says what may be combined.
#include <algorithm>
#include <stdexcept>

#include "core/config/config.h"
#include "core/types/enum_names.h"
#include "tests/accel/traverse/simd_guard.h"
#include "tests/ringbus/identity/factor.h"
#include "tests/ringbus/queues/queue_kinds.h"

namespace carousel::ringbus {
namespace {

using Values = std::vector<std::string>;

template <class E>
Values names(const std::vector<E>& values) {
  Values out;
  for (const E value : values) out.emplace_back(enum_name(value));
  return out;
}

/// The names of all values of an enumeration, those that are refused for now included.
template <class E>
Values all() {
  Values out;
  for (const auto& entry : kEnumNames<E>) out.emplace_back(entry.name);
  return out;
}

const Values kSwitch{"false", "true"};

/// Scenes of surfaces, which the reference tracer knows; tests/app/run/gaussians_test.cpp has machines with Gaussians.
Values scenes_of_surfaces() {
  Values out = all<BuiltinScene>();
  std::erase(out, enum_name(BuiltinScene::kGaussians));
  return out;
}

std::vector<Factor> scene_and_engine() {
  return {
      {"scene.builtin", scenes_of_surfaces()},
      {"scene.levels", {"2", "5"}, {"scene.builtin=instances"}},
      {"test.non_opaque", kSwitch},          // half of the triangles, and spheres; rays have flags
      {"test.away", {"0.5", "100"}},         // rays start so many extents away from the scene
      {"test.storage", {"ample", "least"}},  // storage of collections
      {"test.link_faults", kSwitch},
      {"engine.kind", all<EngineKind>()},
      {"engine.threads", {"1", "2"}, {"engine.kind=native"}},
      {"engine.simd", names(accel::usable_simd_targets())},
      {"engine.lanes", all<Lanes>(), {"engine.kind=native"}},
      {"accuracy.triangle", all<TriangleLevel>()},
      {"accuracy.box", all<BoxLevel>()},
      {"accuracy.transform", all<TransformLevel>()},
      {"accuracy.products", all<AccuracyConfig::Products>(), {"engine.kind=cycle"}},
      {"accuracy.transformed_ray", all<AccuracyConfig::TransformedRay>(), {"engine.kind=cycle"}},
      {"accuracy.instance_data", {"forward", "rt", "inverse"}, {"engine.kind=cycle"}},
      {"bvh.width", {"2", "3", "4", "8"}},
      {"bvh.leaf_triangles", {"1", "4", "16"}},
      {"bvh.elements", all<BvhConfig::Elements>()},
      {"bvh.mixed_triangles", {"0", "2"}},
      {"bvh.top_triangles", {"0", "4"}},
      {"bvh.levels", {"2", "3", "8"}},
      {"bvh.builder", all<BvhConfig::Builder>()},
      {"bvh.duplicates", {"0.2", "3"}},
      {"bvh.merge", all<BvhConfig::Merge>()},
      {"bvh.quality", all<BvhConfig::Quality>(), {"bvh.builder!=octree", "bvh.builder!=kd"}},
  };
}

std::vector<Factor> network() {
  return {
      {"topology.resources", {"1", "2", "5", "16"}},
      {"topology.shape", all<TopologyShape>()},
      {"topology.rings", {"1", "3"}, {"topology.shape=multi_ring"}},
      {"topology.groups", {"1", "3"}, {"topology.shape=hierarchical"}},
      {"topology.trace", all<Tracing>(), {"topology.shape=graph"}},
      {"topology.nodes",
       {R"([{"name": "r", "count": 5}])", R"([{"name": "r", "count": 5}, {"name": "x", "kind": "router"}])",
        R"([{"name": "r", "count": 16, "latency_cycles": 2},
            {"name": "x", "kind": "router", "buffers": 1, "forward": "whole"}])",
        R"([{"name": "r", "count": 5}, {"name": "s", "kind": "shading", "serves": "r[0..1]", "workers": 1},
            {"name": "t", "kind": "shading"}])",
        R"([{"name": "r", "count": 5}, {"name": "x", "kind": "router"}, {"name": "l2", "kind": "cache"},
            {"name": "dram", "kind": "memory", "clock": "noc"}, {"name": "pool", "kind": "shading"}])"},
       {"topology.shape=graph"}},
      {"topology.links",
       {"[]", R"([{"ring": "r[*], x"}])",
        R"([{"from": "r[*]", "to": "x", "both": true, "bytes_per_cycle": 8},
            {"line": "r[0..3]", "both": true, "depth": 2}])",
        R"([{"ring": "r[*]"}, {"from": "r[*]", "all_to": "s, t", "both": true, "bytes_per_cycle": 8,
            "carries": ["new_rays", "completed_rays"]}])",
        R"([{"ring": "r[*], x", "carries": ["packets", "shapes"]},
            {"from": "x", "to": "l2", "both": true, "clock": "core", "carries": ["shapes"]},
            {"from": "l2", "to": "dram", "both": true, "carries": ["shapes"]},
            {"from": "pool", "to": "r[*]", "both": true, "bytes_per_cycle": 16,
             "carries": ["new_rays", "completed_rays"]}])"},
       {"topology.shape=graph"}},
      {"topology.routes", {"shortest", "up_down"}, {"topology.shape=graph"}},
      {"topology.tour", all<Tour>(), {"topology.shape=graph"}},
      {"clocks.noc", {"1000", "700", "1700"}, {"topology.shape=graph", "engine.kind=cycle"}},
      {"topology.form", all<CentralForm>(), {"topology.shape=central"}},
      {"testers.distributor.testers", {"1", "5"}, {"topology.form=distributor"}},
      {"testers.distributor.queue", {"1", "4"}, {"topology.form=distributor"}},
      {"testers.distributor.out_of_order", {"0", "2"}, {"topology.form=distributor"}},
      {"testers.distributor.stragglers", all<TestersConfig::Distributor::Stragglers>(), {"topology.form=distributor"}},
      {"testers.distributor.results_per_cycle", {"1", "4"}, {"topology.form=distributor"}},
      {"topology.visit", all<Visit>()},
      {"topology.flow", all<Flow>()},
      {"topology.link.queue", names(queue_kinds()), {"engine.kind=native"}},
      {"shading.queue", names(many_to_many_kinds()), {"engine.kind=native"}},
      {"shading.queue_depth", {"1", "16"}, {"engine.kind=native"}},
      {"rays.queue", names(many_to_many_kinds()), {"engine.kind=native"}},
      {"rays.queue_depth", {"1", "256"}, {"engine.kind=native"}},
      {"topology.link.depth", {"1", "2", "16"}},
      {"topology.link.latency_cycles", {"1", "4", "30"}, {"engine.kind=cycle"}},
      {"topology.link.bytes_per_cycle", {"4", "64"}, {"engine.kind=cycle"}},
      {"rays.slots_per_resource", {"1", "7", "64", "512"}},
      {"rays.placement", all<Placement>()},
      {"rays.sort", all<RaySort>(), {"engine.kind=native"}},
      {"rays.reads_per_cycle", {"0", "2"}, {"engine.kind=cycle"}},
      {"packets.rays", {"1", "5", "32", "128"}},
      {"packets.shapes", all<PacketShapes>()},
      {"packets.made_per", all<MadePer>(), {"packets.shapes=single"}},
      {"packets.carry", all<PacketCarry>()},
      {"packets.results", all<PacketResults>()},
      {"packets.ids_per_cycle", {"1", "16"}, {"engine.kind=cycle"}},
  };
}

std::vector<Factor> traversal_and_units() {
  using Config = CullPlanesConfig;
  return {
      {"collections.ready", {"1", "16", "300"}},
      {"collections.sort_ids_per_cycle", {"0", "1"}, {"engine.kind=cycle"}},
      {"collections.traversal", all<Traversal>()},
      {"collections.order", all<ChildOrder>()},
      {"collections.key", all<CollectionKey>(), {"engine.kind=cycle", "collections.traversal=ordered"}},
      {"collections.block_bytes", {"64", "1000", "65536"}, {"collections.key=block"}},
      {"bvh.treelets.bytes", {"0", "1", "1000", "20000"}},
      {"collections.grouped", kSwitch, {"bvh.treelets.bytes!=0"}},
      {"bvh.treelet_triangles", {"1", "64", "100000"}, {"collections.traversal=treelet", "bvh.treelets.bytes=0"}},
      {"collections.policy", all<Policy>()},
      {"collections.partial", all<Partial>(), {"engine.kind=cycle"}},
      {"collections.select", all<Select>()},
      {"collections.home", all<Home>()},
      {"collections.when_full", all<WhenFull>()},
      {"testers.box", {"1", "8"}, {"engine.kind=cycle"}},
      {"testers.triangle", {"1", "4"}, {"engine.kind=cycle"}},
      {"testers.simd.lanes", {"1", "8"}, {"engine.kind=cycle"}},
      {"testers.simd.map", all<TestersConfig::Simd::Map>(), {"engine.kind=cycle"}},
      {"testers.stack_entries", {"0", "1"}, {"engine.kind=cycle", "topology.shape=independent"}},
      {"testers.contexts", {"1", "3"}, {"engine.kind=cycle"}},
      {"testers.own_rays", all<TestersConfig::OwnRays>()},
      {"testers.window", {"1", "3"}, {"engine.kind=cycle"}},
      {"testers.any_hit", all<TestersConfig::AnyHit>(), {"engine.kind=cycle", "test.non_opaque=true"}},
      {"cull_planes.count", {"0", "1", "4", "8"}},
      {"cull_planes.nodes", all<Config::Nodes>(), {"cull_planes.count!=0"}},
      {"cull_planes.fit", all<Config::Fit>(), {"cull_planes.count!=0"}},
      {"cull_planes.shared_normals", kSwitch, {"cull_planes.count!=0"}},
      {"cull_planes.order", all<Config::Order>(), {"cull_planes.count!=0"}},
      {"cull_planes.levels", all<Config::Levels>(), {"cull_planes.count!=0"}},
  };
}

std::vector<Factor> bundles() {
  using Config = BundlesConfig;
  const Values on{"bundles.size!=0"}, timed{"bundles.size!=0", "engine.kind=cycle"};
  const Values split{"test.split_early=true"};
  return {
      {"bundles.size", {"0", "2", "4", "16", "32"}},
      {"bundles.form", all<Config::Form>(), on},
      {"bundles.edges", all<Config::Edges>(), timed},
      {"testers.bundle_blocks", all<TestersConfig::BundleBlocks>(), timed},
      {"bundles.order", all<Config::Order>(), on},
      {"bundles.strict", kSwitch, on},
      {"bundles.lifetime", all<Config::Lifetime>(), on},
      {"bundles.split", all<Config::Split>(), on},
      {"bundles.sources", all<Config::Sources>(), on},
      {"bundles.min_rays", {"2", "3"}, on},
      {"test.split_early", kSwitch, on},
      {"bundles.split_below.depth", {"0", "2", "255"}, split},
      {"bundles.split_below.box_size", {"0", "0.2"}, split},
      {"bundles.split_above.spread", {"0", "0.5"}, split},
      {"bundles.split_above.silhouette_area", {"0", "1"}, split},
      {"bundles.at_instances", all<Config::AtInstances>(), on},
      {"bundles.leaf", all<Config::Leaf>(), on},
      {"bundles.hint", all<Config::Hint>(), on},
      {"bundles.builder.open", {"1", "4", "64"}, on},
      {"bundles.builder.rays_per_cycle", {"1", "2"}, timed},
      {"bundles.builder.age", {"3", "64"}, on},
      {"bundles.builder.similarity", all<Config::Builder::Similarity>(), on},
      {"bundles.builder.measure", all<Config::Builder::Measure>(), on},
      {"bundles.builder.threshold", {"100", "0.3"}, on},  // scattered rays are hardly alike
      {"bundles.builder.same_origin", kSwitch, on},
      {"bundles.builder.same_signs", kSwitch, on},
  };
}

std::vector<Factor> memory_and_shading() {
  const Values timed{"engine.kind=cycle"};
  return {
      {"memory.l2_kib", {"2", "1024"}, timed},
      {"memory.l2_banks", {"1", "2"}, timed},
      {"memory.l1_kib", {"0", "1"}, timed},
      {"memory.l2_mshrs", {"0", "1"}, timed},
      {"memory.translation.page_bytes", {"0", "4096"}, timed},
      {"prefetcher.lines", {"0", "2"}, timed},
      {"memory.l2_sector_bytes", {"auto", "32"}, timed},
      {"memory.l2_write", all<MemoryConfig::Write>(), timed},
      {"memory.shared_by", {"1", "4"}, timed},
      {"memory.fetch", all<MemoryConfig::Fetch>(), timed},
      {"memory.l2_answer_bytes_per_cycle", {"0", "8"}, timed},
      {"memory.l2_ray_ways", {"0", "1"}, timed},
      {"memory.ray_records", all<MemoryConfig::RayRecords>(), timed},
      {"memory.path_state", all<MemoryConfig::ShadingData>(), timed},
      {"memory.film", all<MemoryConfig::ShadingData>(), timed},
      {"memory.sky_map", all<MemoryConfig::ShadingData>(), timed},
      {"memory.surfaces", all<MemoryConfig::ShadingData>(), timed},
      {"memory.strip_end", all<MemoryConfig::StripEnd>(), timed},
      {"memory.strip_ahead", {"0", "2"}, {"memory.strip_end=flag"}},
      {"bvh.leaves", all<BvhConfig::Leaves>(), timed},
      {"memory.fetch_ahead", {"0", "2"}, timed},
      {"memory.shape_buffer_kib", {"1", "4"}, timed},
      {"memory.shape_stay", all<MemoryConfig::ShapeStay>(), timed},
      {"shading.workers", {"1", "2", "3"}},
      {"shading.idle_resources_shade", kSwitch, timed},
      {"shading.distribute", all<ShadingConfig::Distribute>(), timed},
      {"shading.cycles_per_shade", {"0", "20"}, timed},
      {"shading.lanes", {"1", "4"}, timed},
      {"shading.sort", all<ShadingConfig::Sort>(), timed},
      {"shading.cycles_per_any_hit", {"0", "10"}, {"testers.any_hit=shader"}},
  };
}

std::vector<Factor> faults() {
  const Values on{"test.link_faults=true"};
  return {
      {"faults.links.drop", {"0.05", "0"}, on},
      {"faults.links.duplicate", {"0.05", "0"}, on},
      {"faults.links.corrupt", {"0.05", "0"}, on},
      {"faults.links.reorder", {"0.05", "0"}, on},
      {"faults.links.delay", {"0.05", "0"}, on},
      {"faults.links.delay_cycles", {"1", "200"}, {"faults.links.delay!=0"}},
      {"faults.resource.kind", all<FaultsConfig::Resource::Kind>()},
      {"faults.resource.number", {"0", "1"}, {"faults.resource.kind!=none"}},
      {"faults.resource.after_rays", {"0", "30"}, {"faults.resource.kind!=none"}},
      {"faults.resource.cycles", {"100", "20000"}, {"faults.resource.kind=pause"}},
      {"faults.resource.factor", {"2", "8"}, {"faults.resource.kind=slow"}},
      {"faults.resource.silence_cycles", {"10", "5000"}, {"faults.resource.kind=stop", "engine.kind=cycle"}},
  };
}

}  // namespace

const std::vector<Factor>& machine_factors() {
  static const std::vector<Factor> factors = [] {
    std::vector<Factor> out;
    for (const auto& part :
         {scene_and_engine(), network(), traversal_and_units(), bundles(), memory_and_shading(), faults()})
      out.insert(out.end(), part.begin(), part.end());
    return out;
  }();
  return factors;
}

std::vector<Factor> machine_factors_with(const std::vector<std::pair<std::string, std::vector<std::string>>>& changes) {
  std::vector<Factor> factors = machine_factors();
  for (const auto& change : changes) {
    const auto found =
        std::find_if(factors.begin(), factors.end(), [&](const Factor& f) { return f.key == change.first; });
    if (found == factors.end()) throw std::logic_error("no factor " + change.first);
    found->values = change.second;
  }
  return factors;
}

}  // namespace carousel::ringbus
