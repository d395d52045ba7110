#pragma once

#include <algorithm>

#include "accel/structure/node.h"
#include "core/types/aabb.h"

namespace carousel::accel {

/// A plane beyond which part of a child's box is empty (US 20250259373): all that stands below the child has
/// n . (x - c) <= distance, exactly, with c = plane_centre() of its box and |n.x| + |n.y| + |n.z| <= 1. With normals
/// of that length a point that is off by e along each axis is off by no more than e along n.
///
/// With Accel::second_spheres a sphere stands in its place, which holds all that stands below the child: `normal` is
/// its centre, `distance` its radius.
struct CullPlane {
  float normal[3];
  float distance;
  friend bool operator==(const CullPlane&, const CullPlane&) = default;
};
static_assert(sizeof(CullPlane) == 16);
inline constexpr int kMaxCullPlanes = 8;

inline DVec3 normal_of(const CullPlane& plane) {
  return {plane.normal[0], plane.normal[1], plane.normal[2]};
}

/// The point from which the distances of a box's planes are measured: the same float wherever it is computed.
[[gnu::always_inline]] inline float plane_centre(float lo, float hi) {
  return 0.5f * lo + 0.5f * hi;
}

/// Planes of a node's child lane, which follow those of the lanes before it.
[[gnu::always_inline]] inline int plane_count(const Node& node, int lane) {
  return static_cast<int>(node.plane_counts >> (4 * lane) & 15u);
}

/// Planes of all lanes of a node.
inline std::uint32_t plane_count(const Node& node) {
  std::uint32_t sum = 0;
  for (int lane = 0; lane < kMaxWidth; ++lane) sum += static_cast<std::uint32_t>(plane_count(node, lane));
  return sum;
}

/// Stored bytes of a node's planes: shared normals count once, and each plane has a distance.
inline std::uint32_t plane_bytes(const Node& node, bool shared_normals) {
  const std::uint32_t planes = node.plane_counts == 0 ? 0 : plane_count(node);
  if (!shared_normals) return planes * static_cast<std::uint32_t>(sizeof(CullPlane));
  int normals = 0;
  for (int lane = 0; lane < kMaxWidth; ++lane) normals = std::max(normals, plane_count(node, lane));
  return static_cast<std::uint32_t>(normals) * 12 + planes * 4;
}

inline Aabb child_box(const Node& node, int lane) {
  Aabb box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lo[axis] = node.plane[axis][lane];
    box.hi[axis] = node.plane[axis + 3][lane];
  }
  return box;
}

}  // namespace carousel::accel
