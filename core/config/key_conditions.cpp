#include "core/config/key_conditions.h"

#include <algorithm>
#include <span>
#include <string>

#include "core/config/keys_without_rays.h"
#include "core/config/machine_conditions.h"

namespace carousel {
namespace {

using namespace conditions;

/// The keys at or below `key` are felt only where the condition holds. More than one row may name a key.
struct Row {
  std::string_view key;
  Condition needed;
};
constexpr Row kRows[] = {
    {"scene.procedural", kSpheres},
    {"scene.triangles", kSizedScene},
    {"scene.instances", kInstances},
    {"scene.levels", kInstances},
    {"scene.gaussians", kGaussians},
    {"scene.gaussians.count", kGaussianCloud},
    {"scene.seed", kSeededScene},
    {"scene.camera", kSceneCamera},
    {"scene.sky", kPicture},
    {"scene.sky.color", kSkyOfOneColor},
    {"scene.sky.rotation", kTurnedSky},
    {"camera", kPicture},
    {"camera.up", kOwnCamera},
    {"camera.focus_distance", kLens},
    {"image.width", kPicture},
    {"image.height", kPicture},
    {"image.samples", kPicture},
    {"image.max_depth", kPicture},
    {"image.max_depth", kSurfaces},
    {"image.exposure", kPicture},
    {"image.files", kPicture},
    {"image.seed", kDrawn},
    {"frames", kPicture},
    {"frames.step", kLaterFrames},
    {"frames.update", kSeveralFrames},
    {"frames.cluster_primitives", kSeveralFrames},
    {"frames.cluster_primitives", kClusters},
    {"frames.builder", kCycle},
    {"frames.builder", kUpdates},
    {"engine.threads", kSeveralParts},
    {"engine.clock_mhz", kClock},
    {"clocks.core", kClock},
    {"clocks.noc", kNetworkClock},
    {"clocks.synchroniser_cycles", kCycle},
    {"clocks.synchroniser_cycles", kTwoClocks},
    {"engine.what_if", kCycle},
    {"engine.lanes", kNative},
    {"engine.lanes", kTreelets},
    {"engine.lanes", kBoxesAlone},
    {"engine.lanes", kWideRegisters},
    {"topology.resources", kFreeSize},
    {"topology.rings", kMultiRing},
    {"topology.groups", kGroups},
    {"topology.form", kCentral},
    {"topology.trace", kGraph},
    {"topology.visit", kTravel},
    {"topology.flow", kTravel},
    {"topology.flow", kFlowRule},
    {"topology.link.queue", kNative},
    {"topology.link.depth", kTravel},
    {"topology.link.depth", kQueuedPorts},
    {"topology.link.latency_cycles", kLinkTime},
    {"topology.link.bytes_per_cycle", kCycle},
    {"topology.overrides", kCycle},
    {"topology.nodes", kGraph},
    {"topology.links", kGraph},
    {"topology.routes", kGraph},
    {"topology.routes", kPackets},
    {"topology.root", kPackets},
    {"topology.ways", kPackets},
    {"topology.routes", kWays},
    {"topology.root", kWays},
    {"topology.ways", kWays},
    {"topology.link.virtual_channels", kQueuedStops},
    {"topology.channels", kQueuedStops},
    {"topology.root", kUpDown},
    {"topology.ways", kGivenWays},
    {"topology.tour", kGraph},
    {"topology.tour", kTravel},
    {"topology.link.virtual_channels", kChannels},
    {"topology.channels", kChannels},
    {"rays.sort", kNative},
    {"rays.reads_per_cycle", kCycle},
    {"rays.banks", kCycle},
    {"rays.query.hits", kList},
    {"rays.query.buffer", kNearest},
    {"rays.query.rounds", kRounds},
    {"rays.query.response_steps", kGaussians},
    {"rays.query.harmonic_steps", kGaussians},
    {"rays.query.harmonic_steps", kHarmonics},
    {"rays.hits_per_ray", kQueryAll},
    {"rays.queue", kNative},
    {"rays.queue_depth", kNative},
    {"packets.shapes", kPackets},
    {"packets.carry", kPackets},
    {"packets.carry", kCycle},
    {"packets.results", kPackets},
    {"packets.results", kCycle},
    {"packets.made_per", kPackets},
    {"packets.ids_per_cycle", kPackets},
    {"packets.ids_per_cycle", kCycle},
    {"collections.ready", kPackets},
    {"collections.traversal", kPackets},
    {"collections.order", kDepthFirst},
    {"collections.key", kPackets},
    {"collections.block_bytes", kBlocks},
    {"collections.policy", kPackets},
    {"collections.select", kPackets},
    {"collections.partial", kPackets},
    {"collections.partial", kCycle},
    {"collections.partial_after_cycles", kPackets},
    {"collections.partial_after_cycles", kWaits},
    {"collections.grouped", kPackets},
    {"collections.grouped", kCutTree},
    {"collections.sort_ids_per_cycle", kPackets},
    {"collections.sort_ids_per_cycle", kCycle},
    {"collections.home", kPackets},
    {"collections.home", kManyResources},
    {"collections.capacity", kPackets},
    {"collections.when_full", kPackets},
    {"bvh.treelet_triangles", kTreelets},
    {"bvh.builder", kBuiltHere},
    {"bvh.quality", kBuiltHere},
    {"bvh.duplicates", kBuiltHere},
    {"bvh.duplicates", kSpaceIsCut},
    {"bvh.micromaps", kAnyHit},
    {"bvh.micromaps.level", kMicromaps},
    {"bvh.leaves", kCycle},
    {"accuracy.spawn", kPicture},
    {"accuracy.transform", kTransforms},
    {"accuracy.products", kCycle},
    {"accuracy.products", kProfile},
    {"accuracy.transformed_ray", kTransforms},
    {"accuracy.transformed_ray", kCycle},
    {"accuracy.instance_data", kTransforms},
    {"accuracy.instance_data", kCycle},
    {"accuracy.invert", kTransforms},
    {"accuracy.invert", kCycle},
    {"cull_planes.object", kPlanes},
    {"cull_planes.nodes", kPlanes},
    {"cull_planes.shared_normals", kPlanes},
    {"cull_planes.fit", kPlanes},
    {"cull_planes.order", kPlanes},
    {"cull_planes.levels", kPlanes},
    {"cull_planes.depth", kPlanes},
    {"bundles.form", kBundles},
    {"bundles.edges", kBundles},
    {"bundles.edges", kSilhouettes},
    {"bundles.edges", kCycle},
    {"bundles.order", kBundles},
    {"bundles.strict", kBundles},
    {"bundles.lifetime", kBundles},
    {"bundles.builder", kBundles},
    {"bundles.builder.rays_per_cycle", kCycle},
    {"bundles.sources", kBundles},
    {"bundles.split", kBundles},
    {"bundles.min_rays", kBundles},
    {"bundles.split_below", kBundles},
    {"bundles.split_above", kBundles},
    {"bundles.at_instances", kBundles},
    {"bundles.leaf", kBundles},
    {"bundles.hint", kBundles},
    {"testers.box", kCycle},
    {"testers.triangle", kCycle},
    {"testers.plane", kCycle},
    {"testers.bundle", kCycle},
    {"testers.transform", kCycle},
    {"testers.procedural", kCycle},
    {"testers.any_hit_unit", kCycle},
    {"testers.micromap_unit", kCycle},
    {"testers.hit_buffer", kCycle},
    {"primitives", kObjects},
    {"programs", kRunsPrograms},
    {"programs.texture_cycles", kShaderPrograms},
    {"programs.trace_cycles", kShaderPrograms},
    {"programs.shaders", kShaderPrograms},
    {"testers.decoder", kCycle},
    {"testers.reciprocal", kCycle},
    {"energy.silhouette", kSilhouettes},
    {"energy.edge", kSilhouettes},
    {"area.silhouette", kSilhouetteUnits},
    {"area.edge", kSilhouetteUnits},
    {"energy.prefetch_vote", kPrefetchesTreelets},
    {"energy.simple_instruction", kRunsPrograms},
    {"energy.product_instruction", kRunsPrograms},
    {"energy.divide_instruction", kRunsPrograms},
    {"energy.branch_instruction", kRunsPrograms},
    {"energy.shade", kConstantShading},
    {"energy.product", kConstantShading},
    {"testers.simd", kCycle},
    {"testers.simd.map", kVectors},
    {"testers.simd.reformat_cycles", kVectors},
    {"testers.distributor", kCycle},
    {"testers.distributor", kDistributor},
    {"testers.simt", kCycle},
    {"testers.simt.warps", kWarps},
    {"testers.simt.step", kWarps},
    {"testers.simt.wait_cycles", kWarps},
    {"testers.simt.lines_per_cycle", kWarps},
    {"testers.simt.stack_entries", kWarps},
    {"testers.simt.compaction", kWarps},
    {"testers.simt.repack_rays_per_cycle", kWarps},
    {"testers.simt.idle_lanes", kWarps},
    {"testers.simt.repack_rays_per_cycle", kRepacks},
    {"testers.simt.prefetch", kWarps},
    {"testers.simt.prefetch_rays", kPrefetchesTreelets},
    {"testers.simt.vote_cycles", kPrefetchesTreelets},
    {"testers.stack_entries", kCycle},
    {"testers.stack_entries", kOwnStacks},
    {"testers.contexts", kCycle},
    {"testers.contexts", kPackets},
    {"testers.window", kCycle},
    {"testers.window", kTravel},
    {"testers.dispatch", kCycle},
    {"testers.dispatch", kTravel},
    {"testers.dispatch", kWindow},
    {"testers.own_rays", kTravel},
    {"testers.own_rays", kOwnersIssue},
    {"testers.any_hit", kCycle},
    {"testers.any_hit", kAnyHit},
    {"testers.bundle_blocks", kCycle},
    {"testers.bundle_blocks", kBundles},
    {"memory", kCycle},
    {"memory.shared_by", kManyResources},
    {"memory.shared_by", kNoDrawnCaches},
    {"memory.l1_ways", kOwnCaches},
    {"memory.l1_lines_per_cycle", kOwnCaches},
    {"memory.l1_mshrs", kOwnCaches},
    {"memory.l1_latency_cycles", kOwnCaches},
    {"memory.dram_latency_cycles", kLatency},
    {"memory.dram_bytes_per_cycle", kPipe},
    {"memory.sky_map", kSkyMap},
    {"memory.surfaces", kPicture},
    {"memory.surfaces", kSurfaces},
    {"memory.surfaces", kConstantShading},
    {"memory.fetch", kPackets},
    {"memory.fetch_ahead", kPackets},
    {"memory.strip_ahead", kEndFlags},
    {"memory.translation.entries", kTranslates},
    {"memory.dram.channels", kBanks},
    {"memory.dram.interleave_bytes", kBanks},
    {"memory.dram.mapping", kBanks},
    {"memory.dram.queue", kBanks},
    {"memory.dram.period_ps", kBanks},
    {"memory.dram.refresh", kBanks},
    {"memory.dram.refresh_cycles", kBanks},
    {"memory.dram.refresh_cycles", kRefresh},
    {"raster", kCycle},
    {"raster", kRaster},
    {"raster.triangles_per_cycle", kRasterTime},
    {"raster.tiles_per_cycle", kRasterTime},
    {"raster.samples_per_cycle", kRasterTime},
    {"raster.bytes_per_cycle", kRasterTime},
    {"raster.requests", kRasterTime},
    {"raster.latency_cycles", kRasterTime},
    {"shading.effects", kPicture},
    {"shading.idle_resources_shade", kCycle},
    {"shading.cycles_per_shade", kCycle},
    {"shading.cycles_per_shade", kConstantShading},
    {"shading.cycles_per_lookup", kConstantShading},
    {"shading.cycles_per_lookup", kSurfaces},
    {"shading.products_per_cycle", kConstantShading},
    {"shading.products_per_cycle", kSurfaces},
    {"shading.program", kCycle},
    {"shading.registers", kShaderPrograms},
    {"shading.instruction_cache", kShaderPrograms},
    {"shading.instruction_cache.line_bytes", kInstructionCache},
    {"shading.instruction_cache.miss_cycles", kInstructionCache},
    {"shading.program.any_hit", kAnyHitShaders},
    {"shading.data_cache", kShaderPrograms},
    {"shading.data_cache", kShaderReads},
    {"shading.data_cache.line_bytes", kDataCache},
    {"shading.data_cache.ways", kDataCache},
    {"shading.data_cache.latency_cycles", kDataCache},
    {"shading.translation", kShaderPrograms},
    {"shading.translation", kShaderReads},
    {"shading.translation.entries", kPages},
    {"shading.cycles_per_lookup", kCycle},
    {"shading.cycles_per_any_hit", kCycle},
    {"shading.cycles_per_any_hit", kAnyHitShaders},
    {"shading.cycles_per_any_hit", kConstantAnyHit},
    {"shading.products_per_cycle", kCycle},
    {"shading.products_per_cycle", kPicture},
    {"shading.lanes", kCycle},
    {"shading.sort", kCycle},
    {"shading.sort_rays_per_cycle", kSorted},
    {"shading.camera_rays", kFlags},
    {"shading.bounce_rays", kFlags},
    {"shading.bounce_rays", kSurfaces},
    {"shading.shadow_rays", kFlags},
    {"shading.shadow_rays", kSurfaces},
    {"shading.camera_rays.force_opaque", kAnyHit},
    {"shading.bounce_rays.force_opaque", kAnyHit},
    {"shading.shadow_rays.force_opaque", kAnyHit},
    {"shading.distribute", kCycle},
    {"shading.queue", kNative},
    {"shading.queue_depth", kNative},
    {"faults.seed", kLinkFaults},
    {"faults.links.delay_cycles", kDelays},
    {"faults.resource.number", kFault},
    {"faults.resource.after_rays", kFault},
    {"faults.resource.cycles", kPause},
    {"faults.resource.factor", kSlow},
    {"faults.resource.recover", kStop},
    {"faults.resource.silence_cycles", kStop},
    {"faults.resource.silence_cycles", kCycle},
    {"faults.compare", kCycle},
    {"sampling.strata", kSampled},
    {"sampling.seed", kSampled},
    {"area.fit", kBudget},
    {"area.aim", kBudget},
    {"area.aim", kBestSplit},
    {"area.link_mm", kProfile},
    {"energy.dram", kNoHbm},
    {"energy.dram_activation", kNoHbm},
    {"energy.dram_activation", kBanks},
    {"energy.hbm", kHbm},
    {"energy.hbm_activation", kHbm},
    {"report.samples", kCycle},
    {"workload.traffic.hotspot", kTrafficHotspot},
    {"workload.traffic.hotspot_fraction", kTrafficHotspot},
    {"workload.traffic.burst_packets", kTrafficBursts},
    {"workload.traffic.destinations", kTrafficAnywhere},
    {"workload.traffic.serve_cycles", kReplies},
};

/// True if `key` is `section` or lies below it.
bool lies_in(std::string_view key, std::string_view section) {
  return key.starts_with(section) && (key.size() == section.size() || key[section.size()] == '.');
}

/// The name below a section; empty if the key does not lie there.
std::string_view name_in(std::string_view key, std::string_view section) {
  if (!lies_in(key, section) || key.size() == section.size()) return {};
  key.remove_prefix(section.size() + 1);
  return key.substr(0, key.find('.'));
}

/// Tells why a key of a part that declares itself has no effect.
std::optional<std::string_view> part_unused(const C& c, const S& s, std::string_view key) {
  std::optional<std::string_view> why;
  Parts::for_each([&]<class P>(std::size_t) {
    if (!lies_in(key, P::kSection)) return;
    if (!kCycle.holds(c, s)) why = kCycle.otherwise;
    const std::string_view name = name_in(key, P::kSection);
    if (!why && !name.empty() && name != P::kSwitch && !P::is_built(c.parts.of<P>())) why = P::kAbsent;
  });
  return why;
}

/// Tells why a key of a test unit, or of the energy or area that a test or a unit costs, has no effect.
std::optional<std::string_view> units_unused(const C& c, const S& s, std::string_view key) {
  const bool cost = lies_in(key, "energy") || lies_in(key, "area");
  const std::string_view name = name_in(key, cost ? key.substr(0, key.find('.')) : "testers");
  const auto row = std::ranges::find(kCostTable, name, &CostRow::key);
  if (cost && row != kCostTable.end() && !kProfile.holds(c, s)) return kProfile.otherwise;
  for (const UnitKindRow& unit : kUnitKinds)
    if (unit.key == name && !has_units(c, s, unit.kind) && !(lies_in(key, "energy.bundle") && has_bundles(c)) &&
        !lies_in(key, "energy.reciprocal"))  // of each ray
      return condition_of(unit.kind)->otherwise;
  return std::nullopt;
}

}  // namespace

std::optional<std::string_view> unused_because(const Config& c, const SceneFacts& scene, std::string_view key) {
  const auto felt = [&](std::string_view section) { return lies_in(key, section); };
  for (const Workloads& workload : kWithoutRays)
    if (c.workload.kind == workload.kind && std::none_of(workload.keys.begin(), workload.keys.end(), felt))
      return workload.otherwise;
  for (const Row& row : kRows)
    if (lies_in(key, row.key) && !row.needed.holds(c, scene)) return row.needed.otherwise;
  if (const auto why = part_unused(c, scene, key)) return why;
  return units_unused(c, scene, key);
}

bool has_units(const Config& config, const SceneFacts& scene, UnitKind kind) {
  const Condition* needed = condition_of(kind);
  return needed == nullptr || needed->holds(config, scene);
}

}  // namespace carousel
