#pragma once

#include "core/statistics/shape_buffer_counts.h"
#include "report/sections/visitor.h"

namespace carousel::report {

/// The nodes and leaves of one level of the structure at one depth, those that instances share counted once.
struct StructureDepth {
  std::string level;
  std::uint64_t depth = 0;
  std::uint64_t inner_nodes = 0, leaves = 0, children = 0, bytes = 0;
  double surface_cost = 0;
  std::optional<StripReads> reads;
};

template <class V>
void describe(V& v, const StructureDepth& r) {
  v.field("level", r.level, "", "top, groups or meshes, as in structure.levels");
  v.field("depth", r.depth, "strips", "strips above, below the root of its own structure");
  v.field("inner_nodes", r.inner_nodes, "nodes", "inner nodes, shared ones once");
  v.field("leaves", r.leaves, "nodes", "leaves, likewise");
  v.field("children_per_node", ratio(r.children, r.inner_nodes), "children/node", "children that an inner node has");
  v.field("bytes", r.bytes, "bytes",
          "nodes and leaves in the machine's memory; a compressed block counts at the first of its leaves");
  v.field("surface_cost", r.surface_cost, "visits/ray",
          "inner nodes and blocks of four primitives that a line through the box of a structure of this level meets "
          "here on average, by the areas of their boxes; mean over structures, weighted by what stands below them");
  v.section("reads", r.reads, "reads of these nodes and leaves by resources (cycle)");
}

}  // namespace carousel::report
