#include <string>

#include <fmt/format.h>

#include "core/config/load/feature_rules.h"

namespace carousel::config {

namespace {

/// Refuses structures whose bytes would have other places or sizes if primitives changed theirs.
void check_clusters(const Config& c, const RuleBreach& breach) {
  const auto no = [&](bool wrong, const char* key, const std::string& message) {
    if (wrong) breach(key, message + ", or frames.update: refit");
  };
  no(c.bvh.treelets.bytes > 0, "bvh.treelets.bytes",
     fmt::format("an update of clusters hangs them below other nodes; expected 0, found {}", c.bvh.treelets.bytes));
  no(c.bvh.mixed_triangles > 0, "bvh.mixed_triangles",
     fmt::format("an update of clusters hangs leaves below other nodes; expected 0, found {}", c.bvh.mixed_triangles));
  no(c.bvh.micromaps.states != BvhConfig::Micromaps::States::kNone, "bvh.micromaps.states",
     fmt::format("an update of clusters puts primitives into other leaves; expected none, found {}",
                 enum_name(c.bvh.micromaps.states)));
  if (c.frames->cluster_primitives.value_or(1) > c.frames->builder.local_primitives)
    breach("frames.cluster_primitives",
           fmt::format("a cluster is built in the builder's store; expected at most frames.builder.local_primitives, "
                       "which are {}, found {}",
                       c.frames->builder.local_primitives, *c.frames->cluster_primitives));
}

/// Refuses structures that hold more than boxes, which nothing here updates, and what no unit is charged for.
void check_update(const Config& c, const RuleBreach& breach) {
  const auto no = [&](bool wrong, const char* key, const std::string& message) {
    if (wrong) breach(key, message + ", or frames.update: none");
  };
  no(c.bvh.elements != BvhConfig::Elements::kBoxes, "bvh.elements",
     fmt::format("an update computes boxes along the axes; expected boxes, found {}", enum_name(c.bvh.elements)));
  no(c.bvh.merge != BvhConfig::Merge::kNone, "bvh.merge",
     fmt::format("an update takes meshes one by one; expected none, found {}", enum_name(c.bvh.merge)));
  no(c.bvh.levels > 2, "bvh.levels",
     fmt::format("groups of instances are not updated yet; expected 2, found {}", c.bvh.levels));
  no(c.cull_planes.count > 0, "cull_planes.count",
     fmt::format("cull planes are not updated yet; expected 0, found {}", c.cull_planes.count));
  no(!c.bvh.file.empty(), "bvh.file", "its trees are those of one moment; expected no file");
  if (c.frames->update != FrameUpdate::kRebuild) {
    no(c.bvh.leaves != BvhConfig::Leaves::kTriangles, "bvh.leaves",
       fmt::format("leaves of another kind have another size when they move; expected triangles, found {}",
                   enum_name(c.bvh.leaves)));
    if (c.frames->update == FrameUpdate::kRefit) return;
    check_clusters(c, breach);
  }
  no(c.bvh.builder != BvhConfig::Builder::kSah, "bvh.builder",
     fmt::format("the builder of the machine divides meshes by their triangles; expected sah, found {}",
                 enum_name(c.bvh.builder)));
  no(c.bvh.quality != BvhConfig::Quality::kFast, "bvh.quality",
     fmt::format("the builder of the machine moves no subtrees; expected fast, found {}", enum_name(c.bvh.quality)));
}

/// Refuses what looks at one frame and would be told of several.
void check_series(const Config& c, const RuleBreach& breach) {
  const auto no = [&](bool wrong, const char* key, const std::string& message) {
    if (wrong) breach(key, message + ", or frames.count: 1");
  };
  no(c.engine.transport != EngineTransport::kLocal, "engine.transport",
     fmt::format("frames are not shared by ranks; expected local, found {}", enum_name(c.engine.transport)));
  no(c.sampling.fraction < 1, "sampling.fraction",
     fmt::format("a series shows whole frames; expected 1, found {}", c.sampling.fraction));
  no(c.faults.compare, "faults.compare", "one run of one frame is compared; expected false, found true");
  no(c.faults.resource.kind != FaultsConfig::Resource::Kind::kNone, "faults.resource.kind",
     fmt::format("happens once in a frame; expected none, found {}", enum_name(c.faults.resource.kind)));
  no(c.verify == Verify::kEffects, "verify", "effects compares one frame; expected none or reference, found effects");
  no(c.area.budget_mm2.has_value(), "area.budget_mm2", "is spent on one scene; expected no budget");
}

}  // namespace

void check_frames(const Config& c, const RuleBreach& breach) {
  if (c.scene.builtin == BuiltinScene::kInstances && c.scene.levels > 2 &&
      ((c.frames && c.frames->count + c.frames->first > 1) || c.scene.time))
    breach("scene.levels", fmt::format("groups of the built-in scene do not move; expected 2, found {}; or neither "
                                       "frames nor scene.time",
                                       c.scene.levels));
  if (!c.frames || (c.frames->count == 1 && c.frames->first == 0)) return;
  if (c.workload.kind != WorkloadConfig::Kind::kRays)
    breach("frames", "a series of pictures has rays of its own; expected workload: rays, or no frames");
  if (c.scene.builtin && !moves(*c.scene.builtin))
    breach("frames", fmt::format("the built-in scene {} does not move; expected spheres, terrain, instances or a "
                                 "scene.file, or no frames",
                                 enum_name(*c.scene.builtin)));
  if (!c.scene.file.empty() && !c.scene.time && !c.scene.animation)
    breach("scene.time", "a series of a file begins at a moment; expected scene.time or scene.animation beside frames");
  if (c.frames->count == 1) return;
  if (c.scene.builtin && c.frames->update == FrameUpdate::kNone && c.frames->step > 0)
    breach("frames.update", fmt::format("the built-in scene {} moves; expected refit, rebuild or clusters, found none",
                                        enum_name(*c.scene.builtin)));
  check_series(c, breach);
  if (c.frames->update != FrameUpdate::kNone) check_update(c, breach);
}

}  // namespace carousel::config
