#include <string>

#include <fmt/format.h>

#include "core/config/load/feature_rules.h"
#include "core/config/machine_conditions.h"

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
  const std::string too_few =
      fmt::format("with fewer than rays.query.nearest = {} a ray finds its hits in rounds; ", c.rays.query.nearest);
  const auto no = [&](bool wrong, const std::string& message) {
    if (wrong) breach("rays.query.buffer", too_few + message + fmt::format("; found {}", *c.rays.query.buffer));
  };
  if (c.topology.shape == TopologyShape::kIndependent) {
    no(c.engine.kind == EngineKind::kNative,
       "expected auto, or engine.kind: cycle, which alone has independent resources with rounds");
    no(conditions::has_warps(c), "expected auto, or testers.simt.warp: 0, as warps have no rounds yet");
    return;
  }
  no(c.collections.traversal != Traversal::kOrdered || c.bvh.treelets.bytes > 0,
     "expected auto, or collections.traversal: ordered without bvh.treelets.bytes, as a ray that waits for several "
     "nodes at once does not know when a round ends");
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
