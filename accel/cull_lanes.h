// Which children of a node their cull planes take away, in either order of planes and box.
//
// What is left of the line is cut by the planes and by the box in both orders, so the same children are culled: the last
// bounds are the same. With planes first a child that the planes alone cull needs no box test; of the others the box
// test goes on with what the planes have left.
#pragma once

#include <cstdint>

#include "accel/accel.h"
#include "accel/cull_plane.h"
#include "accel/cull_plane_test.h"
#include "core/cull_counts.h"
#include "core/test_counts.h"

namespace carousel::accel {

/// Counts a child whose box was hit and which was culled.
inline void count_culled(const Accel& accel, NodeRef child, CullLevel& level) {
  switch (child.kind()) {
    case NodeRef::Kind::kInner: ++level.nodes; break;
    case NodeRef::Kind::kLeaf:
      ++level.leaves;
      level.triangles += child.triangles();
      break;
    case NodeRef::Kind::kInstance:
      ++level.instances;
      level.transforms += !accel.instances[child.instance_index()].transform.identity;
      break;
  }
}

/// Of the child lanes in `mask`, whose boxes were hit, those that no plane shows to be missed. With accel.planes_first
/// the planes of all `lanes` are tested, and box tests that are not needed are taken from counts.box.
[[gnu::noinline]] inline std::uint32_t cull_lanes(const Accel& accel, const Node& node, const CullRay& ray,
                                                  std::uint32_t lanes, std::uint32_t mask, TestCounts& counts,
                                                  CullCounts* culls) {
  CullLevel level;
  const CullPlane* planes = accel.planes.data() + node.first_plane;
  for (int lane = 0; lane < node.count; ++lane) {
    const int count = plane_count(node, lane);
    const CullPlane* const own = planes;
    planes += count;
    const bool hit = (mask >> lane & 1u) != 0;
    if (count == 0 || !(accel.planes_first ? (lanes >> lane & 1u) != 0 : hit)) continue;
    CutLine line(node, lane, ray);
    ++level.children;
    if (!accel.planes_first) line.cut_by_box();
    line.cut_by_planes(own, count, level.plane_tests);
    if (accel.planes_first) {
      level.boxes += line.empty();
      line.cut_by_box();
    }
    if (!line.empty() || !hit) continue;
    mask &= ~(1u << lane);
    ++counts.culled;
    count_culled(accel, node.child[lane], level);
  }
  counts.plane += level.plane_tests;
  counts.box -= level.boxes;
  if (culls != nullptr) culls->at(node.above_instances, node.depth) += level;
  return mask;
}

}  // namespace carousel::accel
