#include "accel/measure/structure_size.h"

#include <algorithm>
#include <unordered_set>
#include <vector>

#include "accel/structure/cull_plane.h"
#include "core/types/aabb.h"

namespace carousel::accel {

namespace {

/// Adds what stands below `root` and is here; `surface_cost` grows by its visits times the mesh's `weight`, or its
/// primitives if that is 0. Nodes that every rank has count at the first.
void add_mesh(const Accel& accel, NodeRef root, double weight, StructureSize& out) {
  struct Open {
    NodeRef ref;
    double area;
  };
  const Partition* const partition = accel.partition.get();
  if (partition != nullptr && !partition->here(root)) return;
  Aabb whole;
  if (root.is_inner())
    for (int lane = 0; lane < accel.nodes[root.node()].count; ++lane)
      whole.extend(child_box(accel.nodes[root.node()], lane));
  double visits = 0;
  std::vector<bool> found;  // a mesh's primitives are numbered from 0 on
  std::uint64_t primitives = 0;
  std::vector<Open> open{{root, whole.half_area()}};
  const double area = whole.half_area();
  while (!open.empty()) {
    const Open at = open.back();
    open.pop_back();
    if (partition != nullptr && !partition->here(at.ref)) continue;
    const double chance = area > 0 ? at.area / area : 1;
    if (!at.ref.is_inner()) {
      ++out.leaves;
      out.references += at.ref.triangles();
      visits += chance * at.ref.blocks();
      for (std::uint32_t i = 0; i < at.ref.triangles(); ++i) {
        const TriangleBlock& block = accel.blocks[at.ref.first_block() + i / kBlockTriangles];
        const std::uint32_t primitive = block.primitive[i % kBlockTriangles] & kPrimitiveMask;
        if (found.size() <= primitive) found.resize(std::max<std::size_t>(primitive + 1, 2 * found.size()));
        primitives += !found[primitive];
        found[primitive] = true;
      }
      continue;
    }
    if (partition == nullptr || partition->rank == 0 || !partition->above(at.ref)) {
      ++out.inner_nodes;
      visits += chance;
    }
    const Node& node = accel.nodes[at.ref.node()];
    for (int lane = 0; lane < node.count; ++lane) open.push_back({node.child[lane], child_box(node, lane).half_area()});
  }
  out.primitives += primitives;
  out.surface_cost += visits * (weight > 0 ? weight : static_cast<double>(primitives));
}

}  // namespace

StructureSize structure_size(const Accel& accel) {
  StructureSize out;
  std::unordered_set<std::uint32_t> roots;
  double all = 0;
  for (const InstanceNode& instance : accel.instances)
    if (!instance.group && instance.triangles > 0 && roots.insert(instance.root.bits()).second) {
      all += instance.triangles;
      add_mesh(accel, instance.root, accel.partition ? instance.triangles : 0, out);
    }
  if (!accel.partition) all = static_cast<double>(out.primitives);
  if (all > 0) out.surface_cost /= all;
  return out;
}

}  // namespace carousel::accel
