#include "accel/builders/top_children.h"

#include <algorithm>

namespace carousel::accel {

namespace {

/// Leaves last, then by size; nodes of one size in order of their numbers.
bool opened_later(const TopChild& a, const TopChild& b) {
  if (a.ref.is_inner() != b.ref.is_inner()) return b.ref.is_inner();
  const float of_a = a.box.half_area(), of_b = b.box.half_area();
  return of_a != of_b ? of_a < of_b : a.ref.bits() > b.ref.bits();
}

}  // namespace

void hang_opened(const InstanceNode& merged, const NodeArray& nodes, std::vector<TopChild>& out) {
  const std::size_t instances = out.size(), most = 2 * instances;
  std::vector<TopChild> open{{merged.root, merged.world, merged.strip_size, merged.triangles}};
  while (open.size() < most && open.front().ref.is_inner()) {
    const Node& node = nodes[open.front().ref.node()];
    std::pop_heap(open.begin(), open.end(), opened_later);
    open.pop_back();
    for (int lane = 0; lane < node.count; ++lane) {
      TopChild child{node.child[lane], {}, node.strip_size[lane], 0};
      for (int axis = 0; axis < 3; ++axis) {
        child.box.lo[axis] = node.plane[axis][lane];
        child.box.hi[axis] = node.plane[axis + 3][lane];
      }
      child.triangles = child.ref.is_inner() ? nodes[child.ref.node()].triangles : child.ref.triangles();
      open.push_back(child);
      std::push_heap(open.begin(), open.end(), opened_later);
    }
  }
  out.insert(out.end(), open.begin(), open.end());
}

}  // namespace carousel::accel
