#include "core/config/load/rank_rules.h"

#include <string>

#include <fmt/format.h>

namespace carousel::config {

namespace {

/// Refuses keys with which the ranks of a partitioned scene would need shapes that they do not have.
void check_placement(const Config& config, const RuleBreach& breach) {
  if (config.scene.placement == ScenePlacement::kReplicated) return;
  const auto refuse = [&](bool wrong, const char* key, const std::string& message) {
    if (wrong) breach(key, message + ", or scene.placement: replicated");
  };
  refuse(config.engine.transport == EngineTransport::kLocal, "scene.placement",
         "one process has the whole scene; expected engine.transport: mpi");
  refuse(config.collections.home != Home::kHash, "collections.home",
         fmt::format("the collections of a partitioned scene are where its shapes are; expected hash, found {}",
                     enum_name(config.collections.home)));
  refuse(
      config.packets.shapes != PacketShapes::kStrip && config.collections.traversal == Traversal::kTreelet,
      "packets.shapes",
      fmt::format("above treelets the strips of a partitioned scene are not taken apart yet; expected strip, found {}",
                  enum_name(config.packets.shapes)));
  refuse(config.cull_planes.count > 0, "cull_planes.count",
         fmt::format("cull planes are not partitioned yet; expected 0, found {}", config.cull_planes.count));
  refuse(config.bvh.elements != BvhConfig::Elements::kBoxes, "bvh.elements",
         fmt::format("{0} are not partitioned yet; expected boxes, found {0}", enum_name(config.bvh.elements)));
  refuse(
      config.bvh.storage != BvhConfig::Storage::kFull, "bvh.storage",
      fmt::format("pieces of boxes are not partitioned yet; expected full, found {}", enum_name(config.bvh.storage)));
  refuse(!config.bvh.file.empty(), "bvh.file",
         fmt::format("trees of a file are not partitioned yet; expected no file, found {}", config.bvh.file));
  refuse(config.bvh.merge != BvhConfig::Merge::kNone, "bvh.merge",
         fmt::format("merged meshes are not partitioned yet; expected none, found {}", enum_name(config.bvh.merge)));
  refuse(config.bvh.levels > 2, "bvh.levels",
         fmt::format("groups are not partitioned yet; expected 2, found {}", config.bvh.levels));
  refuse(config.bvh.top_triangles > 0, "bvh.top_triangles",
         fmt::format("the top level holds no shapes of a partitioned scene; expected 0, found {}",
                     config.bvh.top_triangles));
}

}  // namespace

void check_ranks(const Config& config, const RuleBreach& breach) {
  check_placement(config, breach);
  if (config.engine.transport == EngineTransport::kLocal) return;
  const std::string ranks = fmt::format("engine.transport: {}", enum_name(config.engine.transport));
  const auto refuse = [&](bool wrong, const char* key, const std::string& message) {
    if (wrong) breach(key, message + ", or engine.transport: local");
  };
  refuse(config.engine.kind != EngineKind::kNative, "engine.transport",
         ranks + " is for the native engine, which has messages; expected engine.kind: native");
  refuse(config.workload.kind != WorkloadConfig::Kind::kRays, "workload",
         fmt::format("with {} the ranks share the paths of a picture; expected rays", ranks));
  // A ray that takes a slot on its way would be away from the rank that shades its path.
  refuse(config.rays.placement == Placement::kFirstTaker || config.rays.placement == Placement::kAddressed,
         "rays.placement",
         fmt::format("rays that travel to find slots are not carried over ranks yet; expected balanced or round_robin, "
                     "found {}",
                     enum_name(config.rays.placement)));
  refuse(config.topology.shape == TopologyShape::kGraph, "topology.shape",
         "the links of a graph are not carried over ranks yet; expected ring, bidirectional or point_to_point, found "
         "graph");
  refuse(config.bundles.size > 0, "bundles.size",
         fmt::format("bundles are not carried over ranks yet; expected 0, found {}", config.bundles.size));
  refuse(config.faults.links.any(), "faults.links",
         "faulty links are not carried over ranks yet; expected no faults of links");
  refuse(config.faults.resource.kind != FaultsConfig::Resource::Kind::kNone, "faults.resource.kind",
         fmt::format("faults of resources are not carried over ranks yet, and no run survives the loss of a rank, "
                     "whatever faults.resource.recover says; expected none, found {}",
                     enum_name(config.faults.resource.kind)));
  refuse(config.verify != Verify::kNone, "verify",
         fmt::format("rays are not verified over ranks yet; expected none, found {}", enum_name(config.verify)));
}

}  // namespace carousel::config
