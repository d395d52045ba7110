#pragma once

#include "report/sections/visitor.h"

namespace carousel::report {

/// What the structures over meshes hold, each counted once.
struct Structure {
  std::uint64_t primitives = 0, references = 0, duplicates = 0;
  std::uint64_t inner_nodes = 0, leaves = 0, merged_meshes = 0;
  double surface_cost = 0;
};

template <class V>
void describe(V& v, const Structure& r) {
  v.field("primitives", r.primitives, "triangles", "triangles and procedural primitives of all structures over meshes");
  v.field("references", r.references, "references", "primitives of all their leaves");
  v.field("duplicates", r.duplicates, "references", "references beyond the first of each primitive");
  v.field("inner_nodes", r.inner_nodes, "nodes", "their inner nodes");
  v.field("leaves", r.leaves, "nodes", "their leaves");
  v.field("merged_meshes", r.merged_meshes, "meshes",
          "meshes that have one structure together (`bvh.merge`), which counts as one mesh here");
  v.field("surface_cost", r.surface_cost, "visits/ray",
          "inner nodes and blocks of four primitives that a line through the box of a mesh meets on average, by the "
          "areas of their boxes; mean over meshes, weighted by their primitives");
}

}  // namespace carousel::report
