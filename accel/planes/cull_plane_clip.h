// Cull planes against a ray (US 20250259373, "Culling planes"): the part of a child's box that its planes leave is cut
// with the ray's line, face by face and plane by plane, each bound counting for those after it.
//
// No child may be culled in which the triangle kernel has a hit, rounding included. The watertight kernel's point lies
// on the ray's line to within its own rounding: the sheared corners (A.x, A.y) are computed, but of those the signs of
// the edge values are exact, since rounding is monotone and a zero is settled in double. So weights a >= 0 exist with
// sum a_i (A_i.x, A_i.y) = 0, and the triangle's point p = sum a_i V_i stands beside the line's point at the same
// depth, t* = (p.z - o.z) / d.z. Each A.x = (V.x - o.x) - (d.x / d.z)(V.z - o.z) is off by at most 2 u |V.x - o.x| +
// 4 u |V.z - o.z|, for |d.x| <= |d.z|: with g the largest |V - o| along any axis, p is off the line by 6 u g along x
// and y and by nothing along z, and |t* d| <= g. (An exact hit has p on the line.)
//
// Computed in float, n . (o - c) - distance is off by 6 u g and t* (n . d) by 3 u g, normals being at most 1 long in
// the sum of their entries; dividing adds 4 u g. In all 19 u g: kMarginPerReach has 32. The absolute part covers
// products that underflow in the kernel, where an edge value that is flushed to zero may hide 2^-75.
// (CullPlanes.LoseNoHit... with less, of 2,692,914 hits: 461,167 lost with no margin, 1,889 with 1 u, 69 with 2 u, none
// with 4 u.)
//
// t* may be any depth within the triangle's, and so may the kernel's t, whose weights are rounded: seen edge-on, the
// two have nothing to do with each other. So neither tmin nor the closest hit may bound the line here (3 of the same
// hits were lost when they did, whatever the margin). They are the box test's, whose entries the planes never move.
//
// Above the instances, where the kernel's ray is another than the one that is tested: accel/planes/line_margin.cpp.
#pragma once

#include <cmath>

#include "core/types/vec.h"

namespace carousel::accel {

/// In distances along an axis from the origin to the far side of the box.
inline constexpr float kMarginPerReach = 0x1p-19f;  // 32 u
inline constexpr float kLeastMargin = 0x1p-70f;

/// True if the margins cover the rounding errors of rays of this direction. Outside of the range n . d or a quotient by
/// it may underflow or overflow, and such rays are not culled. Above the instances the kernel's ray is another one,
/// whose direction may be up to 2^30 longer or shorter (accel/planes/line_margin.h).
inline bool covered_by_margin(const Vec3& direction, bool above_instances) {
  const float largest = std::fmax(std::fmax(std::fabs(direction.x), std::fabs(direction.y)), std::fabs(direction.z));
  return above_instances ? largest >= 0x1p-30f && largest <= 0x1p30f : largest >= 0x1p-60f && largest <= 0x1p60f;
}

}  // namespace carousel::accel
