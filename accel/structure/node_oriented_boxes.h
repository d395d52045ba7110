#pragma once

#include "accel/structure/node.h"
#include "core/types/ray.h"

namespace carousel::accel {

/// Boxes that are turned against the axes, around what stands below the lanes of a node, instead of its own boxes
/// (`bvh.elements: oriented_boxes`; US 20250259373, paragraph 77). The three normals of a lane are at right angles to
/// one another, but for rounding, and the entries of each add up to nearly 1 and not more.
struct alignas(32) NodeOrientedBoxes {
  float normal[3][3][kMaxWidth];                     ///< [k][axis][lane]
  float lo[3][kMaxWidth], hi[3][kMaxWidth];          ///< range of n[k] . x over all points x of primitives below
  float box_lo[3][kMaxWidth], box_hi[3][kMaxWidth];  ///< and for all points of their boxes
};
static_assert(sizeof(NodeOrientedBoxes) == 672);

/// As intersect_spheres() (accel/structure/node_spheres.h). Two boxes with the same normals do this:
///
/// The one around the primitives is missed by the whole line of the ray, or the child is visited. A hit's point is off
/// the line by at most 6 u of the way to the triangle's farthest vertex along an axis, and nothing is known of its
/// distance (accel/planes/cull_plane_clip.h), so the range of the ray does not count here.
///
/// The one around their boxes says when the ray enters: a hit is no nearer than a point of the line that is out of the
/// primitive's box, along each axis, by at most 2^-19 of the way to the box's far end (intersect_spheres()).
///
/// Along a normal, whose entries add up to 1 at most, neither error is larger. The way along an axis is at most 3 times
/// the greatest distance to a face along a normal, normals being at least 1 / sqrt(3) long and at right angles. So
/// faces moved out by 2^-17 of that cover both. The arithmetic is double, whose rounding is nothing beside it.
std::uint32_t intersect_oriented_boxes(const NodeOrientedBoxes& boxes, int count, const Vec3& origin,
                                       const Vec3& direction, float tmin, float tmax, float* entry);

}  // namespace carousel::accel
