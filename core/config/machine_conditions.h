#pragma once

#include <algorithm>
#include <string_view>
#include <utility>

#include "core/config/config.h"
#include "core/config/graph/lane_rings.h"
#include "core/config/graph/ring.h"
#include "core/config/graph/routes.h"
#include "core/config/key_conditions.h"

// The conditions under which parts of a machine are in use, for the table of key_conditions.cpp.

namespace carousel::conditions {

using C = Config;
using S = SceneFacts;
using WorkloadKind = WorkloadConfig::Kind;
using Fault = FaultsConfig::Resource::Kind;

/// A condition on a machine, and the clause that says why a machine does not meet it.
struct Condition {
  bool (*holds)(const C&, const S&);
  std::string_view otherwise;
};

constexpr bool meets_rays(const C& c) {
  return c.workload.kind != WorkloadKind::kTraffic && c.workload.kind != WorkloadKind::kMemoryTrace;
}
constexpr bool exchanges_packets(const C& c) {
  return properties_of(c.topology).has_packets;
}
constexpr bool rays_travel(const C& c) {
  return c.rays.placement == Placement::kFirstTaker || c.rays.placement == Placement::kAddressed;
}
constexpr bool packets_travel(const C& c) {
  return exchanges_packets(c) && c.topology.resources > 1 && (c.collections.home != Home::kLocal || rays_travel(c));
}
constexpr bool has_pipe(const C& c) {
  return c.memory.dram.preset == DramConfig::Preset::kPipe;
}
constexpr bool has_hbm(const C& c) {
  return c.memory.dram.preset == DramConfig::Preset::kHbm2;
}
constexpr bool has_bundles(const C& c) {
  return c.bundles.size > 0;
}
constexpr bool has_planes(const C& c, const S& s) {
  return c.cull_planes.count > 0 && s.planes;
}
constexpr bool asks_units(const C& c, const S& s) {
  return s.any_hit && c.testers.any_hit == TestersConfig::AnyHit::kInline;
}
constexpr bool has_micromaps(const C& c) {
  return c.bvh.micromaps.states != BvhConfig::Micromaps::States::kNone;
}
constexpr bool is_generated(const C& c, BuiltinScene scene) {
  return c.scene.builtin == scene;
}
constexpr bool has_many_lanes(const TestersConfig& testers) {
  return testers.simd.lanes > 1;
}

/// Tells whether `test` holds for the testers of some resource.
template <class Test>
bool any_testers(const C& c, const Test& test) {
  return test(c.testers) ||
         any_own(c.topology, [&](const OwnOf& one) { return one.testers != nullptr && test(*one.testers); });
}
inline bool has_warps(const C& c) {
  return any_testers(c, [](const TestersConfig& one) { return one.simt.warp > 0; });
}
constexpr bool has_sky_map(const C& c) {
  return c.scene.sky && !c.scene.sky->file.empty();
}

inline constexpr Condition kCycle{[](const C& c, const S&) { return c.engine.kind == EngineKind::kCycle; },
                                  "the native engine has no clock"};
inline constexpr Condition kNative{[](const C& c, const S&) { return c.engine.kind == EngineKind::kNative; },
                                   "the cycle engine has no real queues"};
inline constexpr Condition kClock{
    [](const C& c, const S&) { return c.engine.kind == EngineKind::kCycle || c.faults.any(); },
    "the native engine has no clock"};
inline constexpr Condition kLinkTime{
    [](const C& c, const S&) {
      return c.engine.kind == EngineKind::kCycle ||
             (c.topology.shape == TopologyShape::kGraph && config::latencies_choose_ways(c.topology));
    },
    kCycle.otherwise};
inline constexpr Condition kPicture{[](const C& c, const S&) { return c.workload.kind == WorkloadKind::kRays; },
                                    "the workload has no picture"};
inline constexpr Condition kFlags{kPicture.holds, "rays of a file or of a plugin carry no such flags"};
inline constexpr Condition kDrawn{[](const C& c, const S&) { return c.workload.kind != WorkloadKind::kRaysFrom; },
                                  "rays of a file are not drawn at random"};
inline constexpr Condition kLatency{
    [](const C& c, const S&) { return has_pipe(c) || c.workload.kind != WorkloadKind::kMemoryTrace; },
    "the memory alone has banks"};
inline constexpr Condition kList{[](const C& c, const S&) { return c.workload.kind == WorkloadKind::kRaysFrom; },
                                 "the rays are of no file"};
inline constexpr Condition kTrafficHotspot{
    [](const C& c, const S&) { return c.workload.traffic.pattern == TrafficConfig::Pattern::kHotspot; },
    "the traffic has no hotspot"};
inline constexpr Condition kTrafficBursts{
    [](const C& c, const S&) { return c.workload.traffic.pattern == TrafficConfig::Pattern::kBursty; },
    "the traffic has no bursts"};
inline constexpr Condition kTrafficAnywhere{[](const C& c, const S&) {
                                              using enum TrafficConfig::Pattern;
                                              const TrafficConfig::Pattern pattern = c.workload.traffic.pattern;
                                              return pattern == kUniform || pattern == kBursty || pattern == kHotspot;
                                            },
                                            "the pattern names each packet's destination"};
inline constexpr Condition kReplies{[](const C& c, const S&) { return c.workload.traffic.reply_bytes > 0; },
                                    "packets call for no answers"};
inline constexpr Condition kQueuedStops{
    [](const C& c, const S&) { return !config::lone_stop_ring_entry(c.topology).has_value(); },
    "nothing waits on a ring with stops"};
inline constexpr Condition kQueuedPorts{
    [](const C& c, const S&) { return meets_rays(c) || !config::lone_stop_ring_entry(c.topology).has_value(); },
    "nothing waits on a ring with stops"};
// Where links have virtual channels, these keep synthetic packets from stopping one another, if anything does.
inline constexpr Condition kFlowRule{
    [](const C& c, const S&) {
      return meets_rays(c) || c.workload.kind != WorkloadKind::kTraffic || config::keeps_lanes(c.topology) ||
             (c.topology.shape != TopologyShape::kGraph && c.topology.shape != TopologyShape::kHierarchical);
    },
    "synthetic packets on a graph follow no such rule, but with topology.channels: none"};
inline constexpr Condition kWays{[](const C& c, const S&) {
                                   const bool traffic = c.workload.kind == WorkloadKind::kTraffic;
                                   return !config::lone_stop_ring_entry(c.topology).has_value() &&
                                          !(traffic && config::keeps_lanes(c.topology));
                                 },
                                 "packets go round the rings"};
inline constexpr Condition kSeveralParts{
    [](const C& c, const S&) { return meets_rays(c) || !config::lone_stop_ring_entry(c.topology).has_value(); },
    "the stops of a ring are clocked together, on one thread"};
inline constexpr Condition kNetworkClock{[](const C& c, const S&) {
                                           return c.engine.kind == EngineKind::kCycle &&
                                                  c.topology.shape == TopologyShape::kGraph &&
                                                  (exchanges_packets(c) || !c.topology.links.empty());
                                         },
                                         "the network has the clock of the resources"};
inline constexpr Condition kTwoClocks{[](const C& c, const S&) {
                                        const auto other = [](const auto& one) { return one.mhz != 0; };
                                        return std::any_of(c.topology.nodes.begin(), c.topology.nodes.end(), other) ||
                                               std::any_of(c.topology.links.begin(), c.topology.links.end(), other);
                                      },
                                      "the network has the clock of the resources"};
inline constexpr Condition kSeededScene{
    [](const C& c, const S&) { return c.scene.builtin && !is_generated(c, BuiltinScene::kCornell); },
    "the scene is not drawn at random"};
inline constexpr Condition kSpheres{[](const C& c, const S&) { return is_generated(c, BuiltinScene::kSpheres); },
                                    "the scene is not the generated one of spheres"};
inline constexpr Condition kSizedScene{[](const C& c, const S&) {
                                         return is_generated(c, BuiltinScene::kSpheres) ||
                                                is_generated(c, BuiltinScene::kTerrain) ||
                                                is_generated(c, BuiltinScene::kSliver) ||
                                                is_generated(c, BuiltinScene::kFoliage);
                                       },
                                       "the scene has as many triangles as it has"};
inline constexpr Condition kGaussianCloud{
    [](const C& c, const S&) { return is_generated(c, BuiltinScene::kGaussians); },
    "the scene is not the generated one of Gaussians"};
inline constexpr Condition kGaussians{[](const C&, const S& s) { return s.gaussians; }, "the scene has no Gaussians"};
inline constexpr Condition kHarmonics{[](const C&, const S& s) { return s.harmonics; },
                                      "the Gaussians have harmonics of degree 0 alone"};
inline constexpr Condition kSurfaces{[](const C&, const S& s) { return !s.gaussians; },
                                     "Gaussians send no rays of their own and have no textures"};
inline constexpr Condition kInstances{[](const C& c, const S&) { return is_generated(c, BuiltinScene::kInstances); },
                                      "the scene is not the generated one of instances"};
inline constexpr Condition kOwnCamera{[](const C& c, const S&) { return c.camera.eye.has_value(); },
                                      "the camera is the scene's"};
inline constexpr Condition kSceneCamera{[](const C& c, const S&) { return !c.camera.eye; },
                                        "camera.eye takes its place"};
inline constexpr Condition kLens{[](const C& c, const S&) { return c.camera.aperture > 0; }, "the camera is a pinhole"};

inline constexpr Condition kLaterFrames{
    [](const C& c, const S&) { return c.frames && c.frames->count + c.frames->first > 1; }, "there is frame 0 alone"};
inline constexpr Condition kSeveralFrames{[](const C& c, const S&) { return c.frames && c.frames->count > 1; },
                                          "there is one frame"};
inline constexpr Condition kUpdates{
    [](const C& c, const S&) { return c.frames && c.frames->count > 1 && c.frames->update != FrameUpdate::kNone; },
    "the structure is built once"};
inline constexpr Condition kClusters{
    [](const C& c, const S&) { return c.frames && c.frames->count > 1 && c.frames->update == FrameUpdate::kClusters; },
    "frames.update chooses no clusters"};

inline constexpr Condition kPackets{[](const C& c, const S&) { return exchanges_packets(c); },
                                    "resources that trace their own rays exchange no packets"};
inline constexpr Condition kTravel{[](const C& c, const S&) { return packets_travel(c); }, "no packet crosses a link"};
inline constexpr Condition kWindow{
    [](const C& c, const S&) { return any_testers(c, [](const TestersConfig& one) { return one.window > 1; }); },
    "testers.window shows a resource one packet at a time"};
inline constexpr Condition kOwnersIssue{[](const C& c, const S&) { return managers_of(c.topology) == 0; },
                                        "the packet_process that issues packets has no rays of its own"};
inline constexpr Condition kManyResources{[](const C& c, const S&) { return c.topology.resources > 1; },
                                          "there is one resource"};
inline constexpr Condition kMultiRing{
    [](const C& c, const S&) { return c.topology.shape == TopologyShape::kMultiRing && c.topology.resources > 1; },
    "the topology is no multi_ring"};
inline constexpr Condition kGroups{
    [](const C& c, const S&) { return c.topology.shape == TopologyShape::kHierarchical && c.topology.resources > 1; },
    "the topology is not hierarchical"};
inline constexpr Condition kGraph{[](const C& c, const S&) { return c.topology.shape == TopologyShape::kGraph; },
                                  "the topology is not drawn"};
inline constexpr Condition kNoDrawnCaches{[](const C& c, const S&) { return !has_drawn_caches(c.topology); },
                                          "caches that are drawn say whom they serve"};
inline constexpr Condition kUpDown{[](const C& c, const S&) {
                                     return c.topology.shape == TopologyShape::kGraph &&
                                            c.topology.routes == Routing::kUpDown;
                                   },
                                   "topology.routes is not up_down"};
inline constexpr Condition kGivenWays{[](const C& c, const S&) {
                                        return c.topology.shape == TopologyShape::kGraph &&
                                               c.topology.routes == Routing::kGiven;
                                      },
                                      "topology.routes is not given"};
// Rays wait at resources, whose places are those of dispatch and tests, and take one channel.
inline constexpr Condition kChannels{
    [](const C& c, const S&) {
      return c.workload.kind == WorkloadKind::kTraffic &&
             (c.topology.shape == TopologyShape::kGraph || c.topology.shape == TopologyShape::kHierarchical);
    },
    "virtual channels carry synthetic traffic on graphs"};
inline constexpr Condition kCentral{[](const C& c, const S&) { return is_central(c.topology); },
                                    "the topology is not central"};
inline constexpr Condition kDistributor{[](const C& c, const S&) { return has_distributor(c); },
                                        "the machine has no distributor"};
inline constexpr Condition kFreeSize{[](const C& c, const S&) {
                                       return !c.area.budget_mm2 || c.area.fit != AreaConfig::Fit::kResources ||
                                              !meets_rays(c);
                                     },
                                     "area.budget_mm2 decides"};

inline constexpr Condition kQueryAll{[](const C& c, const S&) { return c.rays.query.hits == Query::kAll; },
                                     "rays.query.hits is not all"};
inline constexpr Condition kNearest{[](const C& c, const S&) { return c.rays.query.nearest > 0; },
                                    "rays look for one hit"};
inline constexpr Condition kRounds{[](const C& c, const S&) { return c.rays.query.in_rounds(); },
                                   "one round finds all hits"};
inline constexpr Condition kDepthFirst{
    [](const C& c, const S&) {
      return !exchanges_packets(c) || c.collections.traversal != Traversal::kSpread || c.bvh.treelets.bytes > 0;
    },
    "no ray goes depth first"};
inline constexpr Condition kTreelets{[](const C& c, const S&) {
                                       return exchanges_packets(c) && c.collections.traversal == Traversal::kTreelet &&
                                              c.bvh.treelets.bytes == 0;
                                     },
                                     "no treelet is a subtree with so many triangles"};
inline constexpr Condition kBoxesAlone{[](const C& c, const S& s) {
                                         return c.accuracy.box != BoxLevel::kDouble &&
                                                c.bvh.elements == BvhConfig::Elements::kBoxes &&
                                                !is_quantised(c.bvh.storage) && !has_planes(c, s);
                                       },
                                       "lists of rays visit only nodes that hold boxes alone, in float"};
inline constexpr Condition kWideRegisters{
    [](const C& c, const S&) { return c.engine.simd == SimdTarget::kAuto || c.engine.simd == SimdTarget::kAvx3; },
    "lists need registers of sixteen rays, as avx3 has"};
inline constexpr Condition kCutTree{[](const C& c, const S&) { return c.bvh.treelets.bytes > 0; },
                                    "the tree is not cut into treelets"};
inline constexpr Condition kBlocks{[](const C& c, const S&) { return c.collections.key == CollectionKey::kBlock; },
                                   "rays gather at nodes"};
inline constexpr Condition kWaits{[](const C& c, const S&) { return c.collections.partial == Partial::kAfter; },
                                  "collections.partial is not after"};
inline constexpr Condition kBuiltHere{[](const C& c, const S&) { return c.bvh.file.empty(); },
                                      "bvh.file has the trees"};
inline constexpr Condition kSpaceIsCut{[](const C& c, const S&) { return c.bvh.builder != BvhConfig::Builder::kSah; },
                                       "bvh.builder: sah cuts no triangles"};

inline constexpr Condition kPlanes{[](const C& c, const S&) { return c.cull_planes.count > 0; },
                                   "there are no cull planes"};
inline constexpr Condition kPlaneUnits{has_planes, "no node has cull planes"};
inline constexpr Condition kBundles{[](const C& c, const S&) { return has_bundles(c); }, "there are no bundles"};
inline constexpr Condition kSilhouettes{
    [](const C& c, const S&) { return has_bundles(c) && c.bundles.form == BundlesConfig::Form::kSilhouette; },
    "bundles are not tested by silhouettes"};
inline constexpr Condition kSilhouetteUnits{
    [](const C& c, const S& s) { return kSilhouettes.holds(c, s) && !c.area.own[cost_index(Cost::kBundleUnit)]; },
    "bundles are not tested by silhouettes, or area.bundle is given"};
inline constexpr Condition kBundleUnits{[](const C& c, const S&) {
                                          return has_bundles(c) &&
                                                 c.testers.bundle_blocks != TestersConfig::BundleBlocks::kShared;
                                        },
                                        "no units test bundles only"};
inline constexpr Condition kTransforms{[](const C&, const S& s) { return s.transforms; },
                                       "no instance has a transform"};
inline constexpr Condition kObjects{[](const C& c, const S&) { return !c.scene.objects.empty(); },
                                    "scene.objects has none"};
inline constexpr Condition kShaderPrograms{
    [](const C& c, const S&) { return c.shading.program.any() && c.engine.kind == EngineKind::kCycle; },
    "shader workers run no program"};
inline constexpr Condition kShaderReads{
    [](const C& c, const S& s) { return c.workload.kind != WorkloadKind::kRaysFrom && !s.gaussians; },
    "programs meet no surface whose data they read"};
inline constexpr Condition kConstantShading{[](const C& c, const S&) { return !c.shading.program.any(); },
                                            "shading takes the time of its programs"};
inline constexpr Condition kInstructionCache{[](const C& c, const S&) { return c.shading.instruction_cache.bytes > 0; },
                                             "there is no instruction cache"};
inline constexpr Condition kDataCache{[](const C& c, const S&) { return c.shading.data_cache.bytes > 0; },
                                      "shader workers have no data caches"};
inline constexpr Condition kPages{[](const C& c, const S&) { return c.shading.translation.page_bytes > 0; },
                                  "addresses are physical"};
inline constexpr Condition kRunsPrograms{
    [](const C& c, const S& s) { return !c.scene.objects.empty() || kShaderPrograms.holds(c, s); },
    "scene.objects has none, and shader workers run no program"};
inline constexpr Condition kProcedural{[](const C&, const S& s) { return s.procedural; },
                                       "the scene has no procedural primitives"};
inline constexpr Condition kAnyHit{[](const C&, const S& s) { return s.any_hit; }, "every surface is opaque"};
inline constexpr Condition kAnyHitUnits{asks_units, "no units decide any-hit calls"};
inline constexpr Condition kPackedLeaves{
    [](const C& c, const S&) { return c.bvh.leaves == BvhConfig::Leaves::kBlocks; }, "leaves are not compressed"};
inline constexpr Condition kAnyHitShaders{
    [](const C& c, const S& s) { return s.any_hit && c.testers.any_hit == TestersConfig::AnyHit::kShader; },
    "no shader worker decides any-hit calls"};
inline constexpr Condition kConstantAnyHit{[](const C& c, const S&) { return !c.shading.program.any_hit(); },
                                           "any-hit calls take the time of their program"};
inline constexpr Condition kMicromaps{[](const C& c, const S& s) { return s.any_hit && has_micromaps(c); },
                                      "there are no opacity micromaps"};
inline constexpr Condition kVectors{[](const C& c, const S&) { return any_testers(c, has_many_lanes); },
                                    "units have one lane"};

inline constexpr Condition kWarps{[](const C& c, const S&) { return has_warps(c); },
                                  "rays go by themselves, not in warps"};
inline constexpr Condition kOwnStacks{
    [](const C& c, const S&) {
      return !exchanges_packets(c) && any_testers(c, [](const TestersConfig& one) { return one.simt.warp == 0; });
    },
    "no rays that go by themselves have stacks"};
inline constexpr Condition kTranslates{[](const C& c, const S&) { return c.memory.translation.page_bytes > 0; },
                                       "addresses are physical"};
inline constexpr Condition kRaster{[](const C& c, const S&) { return c.primary == Primary::kRaster; },
                                   "primary is rays"};
inline constexpr Condition kRasterTime{
    [](const C& c, const S&) { return c.raster.time == RasterConfig::Time::kCycles; }, "raster.time is free"};
inline constexpr Condition kRepacks{[](const C& c, const S&) {
                                      return any_testers(c, [](const TestersConfig& one) {
                                        return one.simt.compaction == SimtConfig::Compaction::kRepack;
                                      });
                                    },
                                    "rays are not packed into new warps"};
inline constexpr Condition kPrefetchesTreelets{[](const C& c, const S&) {
                                                 return any_testers(c, [](const TestersConfig& one) {
                                                   return one.simt.warp > 0 &&
                                                          one.simt.prefetch == SimtConfig::Prefetch::kTreelet;
                                                 });
                                               },
                                               "warps do not prefetch treelets"};
inline constexpr Condition kOwnCaches{[](const C& c, const S&) { return c.memory.l1_kib > 0; },
                                      "resources have no caches of their own"};
inline constexpr Condition kEndFlags{
    [](const C& c, const S&) { return c.memory.strip_end == MemoryConfig::StripEnd::kFlag; },
    "memory.strip_end is length"};
inline constexpr Condition kPipe{[](const C& c, const S&) { return has_pipe(c); }, "the memory has banks"};
inline constexpr Condition kBanks{[](const C& c, const S&) { return !has_pipe(c); }, "the memory is a pipe"};
inline constexpr Condition kHbm{[](const C& c, const S&) { return has_hbm(c); }, "the memory is no HBM"};
inline constexpr Condition kNoHbm{[](const C& c, const S&) { return !has_hbm(c); }, "the memory is HBM"};
inline constexpr Condition kRefresh{[](const C& c, const S&) { return c.memory.dram.refresh; },
                                    "memory.dram.refresh is off"};

inline constexpr Condition kSorted{[](const C& c, const S&) { return c.shading.sort == ShadingConfig::Sort::kShader; },
                                   "completed rays are not sorted"};
inline constexpr Condition kLinkFaults{[](const C& c, const S&) { return c.faults.links.any(); },
                                       "links have no faults"};
inline constexpr Condition kDelays{[](const C& c, const S&) { return c.faults.links.delay > 0; }, "no frame is late"};
inline constexpr Condition kFault{[](const C& c, const S&) { return c.faults.resource.kind != Fault::kNone; },
                                  "no resource has a fault"};
inline constexpr Condition kPause{[](const C& c, const S&) { return c.faults.resource.kind == Fault::kPause; },
                                  "no resource pauses"};
inline constexpr Condition kSlow{[](const C& c, const S&) { return c.faults.resource.kind == Fault::kSlow; },
                                 "no resource is slow"};
inline constexpr Condition kStop{[](const C& c, const S&) { return c.faults.resource.kind == Fault::kStop; },
                                 "no resource stops"};
inline constexpr Condition kSampled{[](const C& c, const S&) { return c.sampling.fraction < 1; }, "the frame is whole"};
inline constexpr Condition kProfile{[](const C& c, const S&) { return c.energy.profile != CostProfile::kNone; },
                                    "energy.profile is none"};
inline constexpr Condition kBudget{[](const C& c, const S&) { return c.area.budget_mm2.has_value(); },
                                   "there is no area.budget_mm2"};
inline constexpr Condition kBestSplit{[](const C& c, const S&) { return c.area.fit == AreaConfig::Fit::kBest; },
                                      "area.fit is not best"};
inline constexpr Condition kSkyOfOneColor{[](const C& c, const S&) { return !has_sky_map(c); },
                                          "the sky is a map (scene.sky.file)"};
// Where there is no section of a sky, its first key makes one, which takes the place of a built-in scene's own sky.
inline constexpr Condition kTurnedSky{[](const C& c, const S&) { return !c.scene.sky || has_sky_map(c); },
                                      "the sky has no map"};
inline constexpr Condition kSkyMap{[](const C& c, const S&) { return has_sky_map(c); }, "the sky has no map"};

/// The tests of a unit of this kind; null for those that every scene puts to use.
constexpr const Condition* condition_of(UnitKind kind) {
  constexpr std::pair<UnitKind, const Condition*> kConditions[] = {
      {UnitKind::kPlane, &kPlaneUnits},      {UnitKind::kBundle, &kBundleUnits},   {UnitKind::kTransform, &kTransforms},
      {UnitKind::kProcedural, &kProcedural}, {UnitKind::kAnyHit, &kAnyHitUnits},   {UnitKind::kMicromap, &kMicromaps},
      {UnitKind::kHitBuffer, &kNearest},     {UnitKind::kDecoder, &kPackedLeaves}, {UnitKind::kReciprocal, &kBundles},
  };
  for (const auto& [unit, condition] : kConditions)
    if (unit == kind) return condition;
  return nullptr;
}

}  // namespace carousel::conditions
