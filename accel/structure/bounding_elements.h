#pragma once

#include <vector>

#include "accel/structure/node_oriented_boxes.h"
#include "accel/structure/node_spheres.h"

namespace carousel::accel {

/// Elements that bound the children of nodes in place of boxes along the axes, of one kind, by node; or none.
struct BoundingElements {
  std::vector<NodeSpheres> spheres;
  std::vector<NodeOrientedBoxes> oriented_boxes;

  bool empty() const { return spheres.empty() && oriented_boxes.empty(); }
  /// Bytes of the elements of all nodes.
  std::size_t size_bytes() const {
    return spheres.size() * sizeof(NodeSpheres) + oriented_boxes.size() * sizeof(NodeOrientedBoxes);
  }
  /// Bytes of the elements of one node. There must be elements.
  std::size_t node_bytes() const { return spheres.empty() ? sizeof(NodeOrientedBoxes) : sizeof(NodeSpheres); }
  /// The first `count` children of a node that the ray may meet, as intersect_spheres() says. Not for none.
  std::uint32_t intersect(std::uint32_t node, int count, const Vec3& origin, const Vec3& direction, float tmin,
                          float tmax, float* entry) const {
    return spheres.empty() ? intersect_oriented_boxes(oriented_boxes[node], count, origin, direction, tmin, tmax, entry)
                           : intersect_spheres(spheres[node], count, origin, direction, tmin, tmax, entry);
  }
};

}  // namespace carousel::accel
