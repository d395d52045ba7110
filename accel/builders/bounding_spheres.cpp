#include "accel/builders/bounding_spheres.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "accel/structure/accel.h"
#include "accel/structure/cull_plane.h"
#include "accel/structure/primitive_boxes.h"
#include "core/numeric/rounding.h"

namespace carousel::accel {

namespace {

double farthest_corner2(const DVec3& centre, const Aabb& box) {
  const DVec3 lo = centre - DVec3(box.lo), hi = DVec3(box.hi) - centre, far = glm::max(glm::abs(lo), glm::abs(hi));
  return glm::dot(far, far);
}

void raise(const Accel& accel, const Node& node, int lane, const DVec3& centre, double& most) {
  const Aabb box = child_box(node, lane);
  // The box bounds the radius: everything below lies in it.
  if (farthest_corner2(centre, box) <= most) return;
  const NodeRef child = node.child[lane];
  if (child.is_inner()) {
    const Node& below = accel.nodes[child.node()];
    for (int l = 0; l < below.count; ++l) raise(accel, below, l, centre, most);
    return;
  }
  if (child.is_instance()) {
    most = std::max(most, farthest_corner2(centre, box));
    return;
  }
  for (std::uint32_t i = 0; i < child.triangles(); ++i)
    most = std::max(most, farthest_corner2(centre, primitive_box(accel, child, i)));
}

}  // namespace

std::vector<NodeSpheres> bounding_spheres(const Accel& accel, Executor& executor) {
  std::vector<NodeSpheres> all(accel.nodes.size());
  executor.parallel_for(all.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Node& node = accel.nodes[i];
      for (int lane = 0; lane < kMaxWidth; ++lane) {
        const Vec3 centre = lane < node.count ? child_box(node, lane).centre() : Vec3{0};
        for (int axis = 0; axis < 3; ++axis) all[i].centre[axis][lane] = centre[axis];
        double most = 0;
        if (lane < node.count) raise(accel, node, lane, DVec3(centre), most);
        all[i].radius[lane] = rounded_up(std::sqrt(most) * (1 + 0x1p-50));
      }
    }
  });
  return all;
}

}  // namespace carousel::accel
