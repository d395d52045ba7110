#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/config/load/feature_rules.h"
#include "core/config/load/load.h"
#include "core/system/error.h"

namespace carousel::config {

namespace {

/// Refuses what machines whose rays look for several hits cannot do yet.
void check_machine(const Config& c, const RuleBreach& breach) {
  const auto no = [&](bool wrong, const char* key, const std::string& message) {
    if (wrong) breach(key, message + ", or rays.query.nearest: 0");
  };
  no(c.bundles.size > 0, "bundles.size",
     fmt::format("rays of bundles share one bound, and rays that look for several hits have buffers of their own; "
                 "expected 0, found {}",
                 c.bundles.size));
  no(c.primary == Primary::kRaster, "primary", "rasterised camera rays have one hit each; expected rays, found raster");
  no(c.engine.transport != EngineTransport::kLocal, "engine.transport",
     fmt::format("buffers of hits are not carried over ranks yet; expected local, found {}",
                 enum_name(c.engine.transport)));
  no(c.engine.kind == EngineKind::kNative && c.faults.resource.kind == FaultsConfig::Resource::Kind::kStop,
     "faults.resource.kind",
     "the native engine forgets what rays have found before a resource stops, engine.kind: cycle does not; expected "
     "none, pause or slow, found stop");
}

/// A ray begins its next round where its walk ends, which takes a walk of its own.
void check_rounds(const Config& c, const RuleBreach& breach) {
  const QueryConfig& query = c.rays.query;
  const bool holds = query.nearest <= QueryConfig::kMostBuffered;  // so does a buffer of them all
  const auto no = [&](bool wrong, const std::string& message) {
    if (!wrong) return;
    const std::string rounds =
        fmt::format("with fewer than rays.query.nearest = {} a ray finds its hits in rounds; expected ", query.nearest);
    if (holds)
      breach("rays.query.buffer", fmt::format("{}auto, or {}; found {}", rounds, message, query.buffered()));
    else
      breach("rays.query.nearest",
             fmt::format("{}at most {}{}, or {}; found {}", rounds, QueryConfig::kMostBuffered,
                         query.buffer ? " with rays.query.buffer: auto" : "", message, query.nearest));
  };
  if (!properties_of(c.topology).has_packets) {
    no(c.engine.kind == EngineKind::kNative, "engine.kind: cycle, which alone has independent resources with rounds");
    return;
  }
  no(c.collections.traversal != Traversal::kOrdered || c.bvh.treelets.bytes > 0,
     "collections.traversal: ordered without bvh.treelets.bytes, as a ray that waits for several nodes at once does "
     "not know when a round ends");
}

}  // namespace

void check_query(const Config& c, const RuleBreach& breach) {
  const QueryConfig& query = c.rays.query;
  if (query.hits != Query::kClosest && c.workload.kind != WorkloadConfig::Kind::kRaysFrom)
    breach("rays.query.hits",
           "a picture's shaders say which hits they look for; expected closest, or workload: {rays_from: FILE}");
  if (query.hits == Query::kAll && c.verify == Verify::kReference)
    breach("verify",
           "the reference compares one hit a ray; expected none, or another rays.query.hits than all; found reference");
  if (query.buffer && query.nearest > 0 && *query.buffer > query.nearest)
    breach("rays.query.buffer", fmt::format("no ray has more hits than rays.query.nearest = {}; expected at most as "
                                            "many, found {}",
                                            query.nearest, *query.buffer));
  if (query.nearest == 0) return;
  if (query.hits != Query::kClosest)
    breach("rays.query.nearest",
           fmt::format("the nearest hits are those of rays that look for the closest; expected 0, or hits: closest; "
                       "found {} beside hits: {}",
                       query.nearest, enum_name(query.hits)));
  check_machine(c, breach);
  if (query.in_rounds()) check_rounds(c, breach);
}

}  // namespace carousel::config

namespace carousel {

void require_for_gaussians(const Config& config, const KeyPositions& positions) {
  std::vector<ConfigIssue> out;
  const auto no = [&](bool wrong, const char* key, const std::string& message) {
    if (wrong) out.push_back({positions.find(key), key, "the scene consists of Gaussians; " + message});
  };
  no(config.rays.query.nearest == 0, "rays.query.nearest",
     "a ray blends the nearest hits that it finds; expected 1 to 65536, as {nearest: 4096, buffer: 16} has, found 0");
  no(config.workload.kind != WorkloadConfig::Kind::kRays, "workload",
     "they give light to camera rays alone; expected the rays of a picture");
  no(config.verify == Verify::kReference, "verify",
     "the reference knows surfaces alone; expected none, found reference");
  no(config.frames && config.frames->count > 1, "frames.count",
     fmt::format("they do not move; expected 1, found {}", config.frames ? config.frames->count : 1));
  no(config.scene.quantise > 0, "scene.quantise",
     fmt::format("their shapes stay where they are; expected 0, found {}", config.scene.quantise));
  no(config.shading.camera_rays.cull == RayFlags::Cull::kFront, "shading.camera_rays.cull",
     "rays meet them at their fronts; expected none or back, found front");
  no(!config.scene.objects.empty(), "scene.objects",
     fmt::format("rays blend these alone, and an object is none; expected no objects, found {}",
                 config.scene.objects.size()));
  if (config.scene.gaussians.geometry == GaussiansConfig::Geometry::kTriangles) {
    // A leaf's test reads the records of its Gaussians, which are not beside more than a leaf.
    const std::string spheres = ", or scene.gaussians.geometry: ellipsoids";
    no(config.bvh.mixed_triangles > 0, "bvh.mixed_triangles",
       fmt::format("triangles around them are in leaves; expected 0{}; found {}", spheres, config.bvh.mixed_triangles));
    no(config.bvh.treelets.bytes > 0, "bvh.treelets.bytes",
       fmt::format("a treelet of triangles does not bring their records; expected 0{}; found {}", spheres,
                   config.bvh.treelets.bytes));
    no(config.collections.key == CollectionKey::kBlock, "collections.key",
       fmt::format("a block of memory does not bring the records of its triangles; expected node{}; found block",
                   spheres));
  }
  no(!config.bvh.file.empty(), "bvh.file", "trees of files are those of other meshes; expected none");
  if (!out.empty()) throw ConfigError(std::move(out));
}

}  // namespace carousel
