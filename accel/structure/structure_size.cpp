#include "accel/structure/structure_size.h"

#include <algorithm>
#include <unordered_set>
#include <vector>

#include "core/types/aabb.h"

namespace carousel::accel {

namespace {

Aabb lane_box(const Node& node, int lane) {
  Aabb box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lo[axis] = node.plane[axis][lane];
    box.hi[axis] = node.plane[axis + 3][lane];
  }
  return box;
}

/// Adds what stands below `root`; `surface_cost` grows by its visits times its primitives.
void add_mesh(const Accel& accel, NodeRef root, StructureSize& out) {
  struct Open {
    NodeRef ref;
    double area;
  };
  Aabb whole;
  if (root.is_inner())
    for (int lane = 0; lane < accel.nodes[root.node()].count; ++lane)
      whole.extend(lane_box(accel.nodes[root.node()], lane));
  double visits = 0;
  std::uint32_t last = 0;  // a mesh's primitives are numbered from 0 on, and its leaves hold each
  std::vector<Open> open{{root, whole.half_area()}};
  const double area = whole.half_area();
  while (!open.empty()) {
    const Open at = open.back();
    open.pop_back();
    const double chance = area > 0 ? at.area / area : 1;
    if (!at.ref.is_inner()) {
      ++out.leaves;
      out.references += at.ref.triangles();
      visits += chance * at.ref.blocks();
      for (std::uint32_t i = 0; i < at.ref.triangles(); ++i) {
        const TriangleBlock& block = accel.blocks[at.ref.first_block() + i / kBlockTriangles];
        last = std::max(last, block.primitive[i % kBlockTriangles] & kPrimitiveMask);
      }
      continue;
    }
    ++out.inner_nodes;
    visits += chance;
    const Node& node = accel.nodes[at.ref.node()];
    for (int lane = 0; lane < node.count; ++lane) open.push_back({node.child[lane], lane_box(node, lane).half_area()});
  }
  out.primitives += last + 1;
  out.surface_cost += visits * (last + 1.0);
}

}  // namespace

StructureSize structure_size(const Accel& accel) {
  StructureSize out;
  std::unordered_set<std::uint32_t> roots;
  for (const InstanceNode& instance : accel.instances)
    if (!instance.group && instance.triangles > 0 && (!accel.partition || accel.partition->here(instance.root)) &&
        roots.insert(instance.root.bits()).second)
      add_mesh(accel, instance.root, out);
  if (out.primitives > 0) out.surface_cost /= static_cast<double>(out.primitives);
  return out;
}

}  // namespace carousel::accel
