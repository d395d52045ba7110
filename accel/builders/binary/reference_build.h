#pragma once

#include <vector>

#include "accel/builders/binary/sah_build.h"
#include "core/config/fields/bvh.h"

namespace carousel::accel {

/// A tree that may hold a primitive several times, each time with another piece of its box: as build_sah(), but nodes
/// are also divided by planes in space, and a primitive with a box on both sides of one goes to both, its box cut
/// there. `primitives` becomes the list of these references, of which leaves are ranges; a leaf holds none twice.
///
/// - spatial: where a plane costs less than the best division by primitives (Stich, Friedrich, Dietrich 2009, "Spatial
///   splits in bounding volume hierarchies").
/// - kd: at the plane of the least cost as long as there is one (Wald, Havran 2006, "On building fast kd-trees for ray
///   tracing, and on doing that in O(N log N)").
/// - octree: at the middles of a cube's cells, x, y and z by turns (Glassner 1984, "Space subdivision for fast ray
///   tracing").
///
/// Planes cut at most `duplicates` times the number of primitives; a node's share of that goes to its children by their
/// sizes. The tree is the same for any executor.
///
/// Boxes are cut, never fitted to the part of a primitive that lies in them, and that is what keeps one answer for
/// every ray and every level of accuracy, with no margin at all. A hit passes its primitive's box, entered no later
/// than t' (docs/how-it-works/design.md, What a hit is). Cut a box that a ray passes so at the plane s, into L before s
/// and R behind it, along the ray. L is entered as the box is, and left at f, the rounded distance of s, or earlier
/// only if the box is. If L is missed, then f is nearer than the entry of the box; the distance n of s as a near plane
/// is no farther than f if s lies ahead (far distances are widened, never narrowed) and not positive otherwise, hence n
/// too is nearer than that entry, and R is entered and left as the box is. If L is not missed, it is entered as the box
/// is. So one of the two is passed and entered no later than the box; by induction so is one of the references, and
/// every node around it. The part of a triangle in a cell has a smaller box than that, but to fit it would need a
/// margin that grows with the distance of the ray's origin, and for triangles seen edge-on, whose t' rounding decides,
/// none would do.
BinaryTree build_references(BuildPrimitives& primitives, const SahSettings& settings, BvhConfig::Builder builder,
                            double duplicates);

}  // namespace carousel::accel
