#pragma once

#include "report/sections/structure/depths.h"
#include "report/sections/visitor.h"

namespace carousel::report {

/// The structures of one kind, each counted once: those that instances share, too.
struct StructureLevel {
  std::string level;
  std::uint64_t structures = 0, inner_nodes = 0, leaves = 0, instances = 0, depth = 0;
  std::uint64_t children = 0;  ///< children of all inner nodes
  std::uint64_t node_bytes = 0, leaf_bytes = 0, record_bytes = 0;
  double surface_cost = 0;
  std::optional<StripReads> reads;

  std::uint64_t bytes() const { return node_bytes + leaf_bytes + record_bytes; }
};

template <class V>
void describe(V& v, const StructureLevel& r) {
  v.field("level", r.level, "",
          "top (over the instances of the world), groups (over members of groups) or meshes (over primitives)");
  v.field("structures", r.structures, "structures", "structures of this level, shared ones once");
  v.field("inner_nodes", r.inner_nodes, "nodes", "inner nodes of these");
  v.field("leaves", r.leaves, "nodes", "leaves of these");
  v.field("instances", r.instances, "instances", "instances, or placements of groups, that lead to these");
  v.field("depth", r.depth, "strips", "strips on the longest way from a root of these down");
  v.field("children_per_node", ratio(r.children, r.inner_nodes), "children/node",
          "children that an inner node has, of the bvh.width that it has room for");
  v.field("node_bytes", r.node_bytes, "bytes",
          "inner nodes in the machine's memory, with what stands behind them: cull planes, primitives held");
  v.field("leaf_bytes", r.leaf_bytes, "bytes", "leaves in the machine's memory");
  v.field("record_bytes", r.record_bytes, "bytes",
          "records of the instances that lead here: transforms, boxes of members");
  v.field("bytes", r.bytes(), "bytes", "nodes, leaves and records");
  v.field("surface_cost", r.surface_cost, "visits/ray", "sum of that of its depths in structure.depths");
  v.section("reads", r.reads, "reads of its nodes and leaves by resources (cycle)");
}

/// The whole tree cut into connected pieces (`bvh.treelets`).
struct Treelets {
  std::uint64_t limit = 0, count = 0, nodes = 0, leaves = 0, exits = 0, most_exits = 0, depth = 0;
  std::uint64_t bytes = 0, smallest = 0, largest = 0;
};

template <class V>
void describe(V& v, const Treelets& r) {
  v.field("limit", r.limit, "bytes", "bvh.treelets.bytes; a node or leaf that is larger is a treelet by itself");
  v.field("count", r.count, "treelets", "connected pieces, those of a mesh once for all of its placements");
  v.field("nodes", r.nodes, "nodes", "inner nodes in them");
  v.field("leaves", r.leaves, "nodes", "leaves in them");
  v.field("bytes", r.bytes, "bytes", "size of their nodes and leaves, without gaps between treelets");
  v.field("smallest", r.smallest, "bytes", "size of the smallest");
  v.field("mean", ratio(r.bytes, r.count), "bytes", "mean size");
  v.field("largest", r.largest, "bytes", "size of the largest");
  v.field("fill", ratio(r.bytes, r.count * r.limit), "fraction",
          "mean size over the limit; above 1 where nodes are larger");
  v.field("exits", ratio(r.exits, r.count), "treelets/treelet", "mean number of ways from a treelet into others");
  v.field("most_exits", r.most_exits, "treelets", "the largest such number");
  v.field("depth", r.depth, "treelets", "treelets on the longest way down, through all levels of the structure");
}

/// The contents of the structures over meshes, each counted once, and all levels of the structure.
struct Structure {
  std::uint64_t primitives = 0, references = 0, duplicates = 0;
  std::uint64_t inner_nodes = 0, leaves = 0, merged_meshes = 0;
  double surface_cost = 0;
  std::optional<std::uint64_t> bytes;
  std::optional<std::vector<StructureLevel>> levels;
  std::optional<std::vector<StructureDepth>> depths;
  std::optional<Treelets> treelets;
};

template <class V>
void describe(V& v, const Structure& r) {
  v.field("primitives", r.primitives, "triangles", "triangles and procedural primitives of all structures over meshes");
  v.field("references", r.references, "references", "primitives of all their leaves");
  v.field("duplicates", r.duplicates, "references", "references beyond the first of each primitive");
  v.field("inner_nodes", r.inner_nodes, "nodes", "their inner nodes, those above the instances not among them");
  v.field("leaves", r.leaves, "nodes", "their leaves");
  v.field("merged_meshes", r.merged_meshes, "meshes",
          "meshes that have one structure together (`bvh.merge`), which counts as one mesh here");
  v.field("surface_cost", r.surface_cost, "visits/ray",
          "inner nodes and blocks of four primitives that a line through the box of a mesh meets on average, by the "
          "areas of their boxes; mean over meshes, weighted by their primitives");
  v.field(
      "bytes", r.bytes, "bytes",
      "size of the whole structure in the machine's memory, gaps for alignment included; absent where ranks share it");
  v.section("levels", r.levels, "the structure level by level, from the top down; absent where ranks share it");
  v.section("depths", r.depths, "each level depth by depth; absent where ranks share the structure");
  v.section("treelets", r.treelets, "pieces of the whole tree; absent without bvh.treelets");
}

}  // namespace carousel::report
