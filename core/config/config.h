#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/config/fields/accuracy.h"
#include "core/config/fields/bundles.h"
#include "core/config/fields/bvh.h"
#include "core/config/fields/camera.h"
#include "core/config/fields/collections.h"
#include "core/config/fields/cull_planes.h"
#include "core/config/fields/energy.h"
#include "core/config/fields/engine.h"
#include "core/config/fields/faults.h"
#include "core/config/fields/image.h"
#include "core/config/fields/memory.h"
#include "core/config/fields/packets.h"
#include "core/config/fields/rays.h"
#include "core/config/fields/report.h"
#include "core/config/fields/sampling.h"
#include "core/config/fields/scene.h"
#include "core/config/fields/shading.h"
#include "core/config/fields/testers.h"
#include "core/config/fields/topology.h"
#include "core/config/fields/workload.h"
#include "core/config/parts.h"

namespace carousel {

enum class Primary { kRays, kRaster };
template <>
inline constexpr auto kEnumNames<Primary> = [] {
  using enum Primary;
  return names<Primary>({{kRays, "rays"}, {kRaster, "raster"}});
}();

enum class Verify { kNone, kReference, kEffects };
template <>
inline constexpr auto kEnumNames<Verify> = [] {
  using enum Verify;
  return names<Verify>({{kNone, "none"}, {kReference, "reference"}, {kEffects, "effects"}});
}();

/// The configuration tree (docs/reference/config, a contract): plain structs, filled once and then only read. A part
/// that needs one section includes only the file of that section.
struct Config {
  std::int64_t schema_version = 1;
  SceneConfig scene;
  CameraConfig camera;
  ImageConfig image;
  std::optional<FramesConfig> frames;  ///< absent: one picture, of the moment that `scene` names
  EngineConfig engine;
  ClocksConfig clocks;
  TopologyConfig topology;
  RaysConfig rays;
  PacketsConfig packets;
  CollectionsConfig collections;
  BvhConfig bvh;
  AccuracyConfig accuracy;
  CullPlanesConfig cull_planes;
  BundlesConfig bundles;
  TestersConfig testers;
  PrimitivesConfig primitives;
  ProgramsConfig programs;
  MemoryConfig memory;
  PartKeys<Parts> parts;
  ShadingConfig shading;
  FaultsConfig faults;
  EnergyConfig energy;
  AreaConfig area;
  SamplingConfig sampling;
  ReportConfig report;
  Verify verify = Verify::kNone;
  WorkloadConfig workload;
  std::map<std::string, std::vector<std::string>> vary;  ///< key path to values; for sweep
  Primary primary = Primary::kRays;
  RasterConfig raster;
};

/// A central machine of test cells, each of which tests the rays of its places in ray memory.
inline bool has_cells(const Config& c) {
  return is_central(c.topology) && c.topology.form == CentralForm::kCells;
}

/// A central machine with a distributor in front of testers.
inline bool has_distributor(const Config& c) {
  return is_central(c.topology) && c.topology.form == CentralForm::kDistributor;
}

/// Testers of a resource that have units, and a share of its ray memory, of their own.
inline std::int64_t own_testers(const Config& c) {
  return has_distributor(c) ? c.testers.distributor.testers : 1;
}

/// The number of shader workers that `shading.workers` stands for, or of all drawn pools, if each names its own.
inline std::int64_t shader_workers(const Config& c) {
  if (const DrawnPools drawn = drawn_pools(c.topology); drawn.pools > 0 && drawn.silent == 0) return drawn.workers;
  return c.shading.workers.value_or(
      c.engine.kind == EngineKind::kCycle ? std::min<std::int64_t>(256, 2 * ray_owners(c.topology)) : 2);
}

/// Returns the workers of each pool in the order of the drawing, or of the only pool. Pools without a number share what
/// the others leave, and the first of them have one more where it does not come out even.
inline std::vector<std::int64_t> pool_workers(const Config& c) {
  const DrawnPools drawn = drawn_pools(c.topology);
  const std::int64_t left = shader_workers(c) - drawn.workers;
  if (drawn.pools == 0) return {left};
  std::vector<std::int64_t> out;
  std::int64_t silent = 0;
  for (const GraphNode& node : c.topology.nodes)
    for (std::int64_t i = 0; node.kind == GraphNodeKind::kShading && i < node.count.value_or(1); ++i)
      out.push_back(node.workers ? *node.workers : left / drawn.silent + (silent++ < left % drawn.silent ? 1 : 0));
  return out;
}

namespace config {

template <class V>
void describe(V& v, Config& c) {
  v.field("schema_version", c.schema_version, IntRange{1, 1}, "", "The version of these keys.");
  v.section("scene", c.scene, "The scene that is rendered.");
  v.section("camera", c.camera, "The place, the view and the lens of the camera.");
  v.section("image", c.image, "The picture and its paths.");
  v.section("frames", c.frames, "A series of pictures of a scene that moves.");
  v.section("engine", c.engine, "The engine that simulates the machine.");
  v.section("clocks", c.clocks, "The clocks of the resources and of the network between them.");
  v.section("topology", c.topology, "The resources and their links.");
  v.section("rays", c.rays, "The storage of rays.");
  v.section("packets", c.packets, "The packets that travel.");
  v.section("collections", c.collections, "The rays that wait for a node.");
  v.section("bvh", c.bvh, "The acceleration structure.");
  v.section("accuracy", c.accuracy, "The arithmetic of the tests.");
  v.section("cull_planes", c.cull_planes, "Planes that mark parts of boxes as empty.");
  v.section("bundles", c.bundles, "Bundles of similar rays that are tested as one.");
  v.section("testers", c.testers, "The test units of a resource. A bare number is the number of units.");
  v.section("primitives", c.primitives, "Primitives of your own, by name, each with an intersection program.");
  v.section("programs", c.programs, "The units that run programs: the time of an instruction.");
  v.section("memory", c.memory, "The caches and the memory of the simulated machine.");
  Parts::for_each([&]<class P>(std::size_t) { v.section(P::kSection, c.parts.template of<P>(), P::kMeaning); });
  v.section("shading", c.shading, "The shader workers and the effects.");
  v.choice("primary", c.primary,
           "The first surface that a pixel shows is found by camera rays, or by a rasteriser, which leaves the other "
           "rays to the machine and needs a pinhole.");
  v.section("raster", c.raster, "The unit that rasterises first hits in the simulated machine.");
  v.section("faults", c.faults, "Faults that happen on request.");
  v.section("sampling", c.sampling, "A part of the frame that stands for all of it.");
  v.section("energy", c.energy, "The joules of an event. Every number may be given instead of the profile's.");
  v.section("area", c.area, "The area of a part, with the profile of energy.");
  v.section("report", c.report, "The report of a run.");
  v.choice("verify", c.verify,
           "With reference every ray is traced again, depth first, and compared. With effects the picture is computed "
           "again with all effects and compared.");
  v.workload("workload", c.workload,
             "The rays of the picture, the rays of a file, synthetic traffic, or requests to the memory alone.");
  v.vary("vary", c.vary, "The values of keys for sweep, as in key.path: [a, b, c].");
}

}  // namespace config
}  // namespace carousel
