#pragma once

#include "report/sections/visitor.h"

namespace carousel::report {

/// The memory that instances of instances take, and the memory that they would take if each placement of a group had
/// nodes of its own.
struct Levels {
  std::uint64_t levels = 2;
  std::uint64_t groups = 0, placements = 0;
  std::uint64_t nodes = 0, nodes_of_groups = 0, nodes_of_groups_unshared = 0;
  std::uint64_t node_bytes = 0, node_bytes_unshared = 0, placement_bytes = 0;
};

template <class V>
void describe(V& v, const Levels& r) {
  v.field("levels", r.levels, "levels", "structures one below another on the longest way down, meshes included");
  v.field("groups", r.groups, "groups", "structures over groups of instances");
  v.field("placements", r.placements, "placements", "placements of these groups in the world and in each other");
  v.field("nodes", r.nodes, "nodes", "inner nodes of all levels");
  v.field("nodes_of_groups", r.nodes_of_groups, "nodes", "those of the groups, which their placements share");
  v.field("nodes_of_groups_unshared", r.nodes_of_groups_unshared, "nodes",
          "nodes of the groups, if each placement had its own");
  v.field("node_bytes", r.node_bytes, "bytes", "size of all inner nodes");
  v.field("node_bytes_unshared", r.node_bytes_unshared, "bytes", "the same, if each placement of a group had its own");
  v.field("placement_bytes", r.placement_bytes, "bytes", "size of the placements of groups and their lists of members");
}

}  // namespace carousel::report
