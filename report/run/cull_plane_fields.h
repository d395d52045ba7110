#pragma once

#include "report/run/cull_planes.h"

namespace carousel::report {

template <class V>
void describe(V& v, CullPlaneLevel& r) {
  v.field("structure", r.structure, "", "top (above the instances) or bottom (below one)");
  v.field("depth", r.depth, "nodes", "of the node whose children these are, below the root of the structure");
  v.field("children_tested", r.children_tested, "children", "whose planes were tested, each time");
  v.field("plane_tests", r.plane_tests, "tests", "of their planes");
  v.field("culled", r.culled, "children", "whose box was hit, which a cull plane showed to be missed");
  v.field("box_tests_spared", r.box_tests_spared, "tests", "of children that their planes culled first");
  v.field("nodes_spared", r.nodes_spared, "nodes", "inner nodes that a ray did not have to fetch, culled ones");
  v.field("leaves_spared", r.leaves_spared, "leaves", "the same of leaves");
  v.field("triangle_tests_spared", r.triangle_tests_spared, "tests",
          "triangles of those leaves; at most, since a closer hit may spare some as well");
  v.field("transforms_spared", r.transforms_spared, "rays",
          "that did not have to be brought to model space; at least, since each strip of the instance may want one");
}

template <class V>
void describe(V& v, CullPlanes& r) {
  v.field("planes", r.planes, "planes", "of all children of nodes");
  v.field("bytes", r.bytes, "bytes", "of them");
  v.field("bytes_per_node", r.bytes_per_node, "bytes/node", "beside the 256 of each node");
  v.section("levels", r.levels, "depths at which planes were tested");
}

}  // namespace carousel::report
