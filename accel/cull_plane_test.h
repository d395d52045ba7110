// Cull planes against a ray (US 20250259373, "Culling planes"): the part of a child's box that its planes leave is cut
// with the ray's line, face by face and plane by plane, each bound counting for those after it.
//
// Nothing may be culled that the triangle kernel hits, rounding included. What the watertight kernel reports lies on
// the ray's line to within its own rounding: the sheared corners (A.x, A.y) are computed, but of those the signs of
// the edge values are exact, since rounding is monotone and a zero is settled in double. So weights a >= 0 exist with
// sum a_i (A_i.x, A_i.y) = 0, and the triangle's point p = sum a_i V_i stands beside the line's point at the same
// depth, t* = (p.z - o.z) / d.z. Each A.x = (V.x - o.x) - (d.x / d.z)(V.z - o.z) is off by at most 2 u |V.x - o.x| +
// 4 u |V.z - o.z|, for |d.x| <= |d.z|: with g the largest |V - o| along any axis, p is off the line by 6 u g along x
// and y and by nothing along z, and |t* d| <= g. (An exact hit has p on the line.)
//
// Computed in float, n . (o - c) - distance is off by 6 u g and t* (n . d) by 3 u g, normals being at most 1 long in the
// sum of their entries; dividing adds 4 u g. In all 19 u g: kMarginPerReach has 32. The absolute part covers products
// that underflow in the kernel, where an edge value that is flushed to zero may hide 2^-75. (CullPlanes.LoseNoHit...
// with less, of 2,692,914 hits: 461,167 lost with no margin, 1,889 with 1 u, 69 with 2 u, none with 4 u.)
//
// t* may be any depth within the triangle's, and so may the kernel's t, whose weights are rounded: seen edge-on, the
// two have nothing to do with each other. So neither tmin nor the closest hit may bound the line here (3 of the same
// hits were lost when they did, whatever the margin). They are the box test's, whose entries the planes never move.
#pragma once

#include <cmath>
#include <cstdint>

#include "accel/cull_plane.h"
#include "accel/node.h"
#include "core/ray.h"
#include "core/test_counts.h"

namespace carousel::accel {

/// In distances along an axis from the origin to the far side of the box.
inline constexpr float kMarginPerReach = 0x1p-19f;   // 32 u
inline constexpr float kLeastMargin = 0x1p-70f;

/// A ray as the plane test wants it, in the space of the nodes.
struct CullRay {
  float origin[3], direction[3], inverse[3];
  float margin_per_reach;

  CullRay(const float* o, const Vec3& d) {
    float largest = 0;
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis] = o[axis];
      direction[axis] = d[axis];
      inverse[axis] = 1.0f / d[axis];
      largest = std::fmax(largest, std::fabs(d[axis]));
    }
    // Outside of this n . d or a quotient by it may underflow or overflow: such rays are not culled.
    const bool sound = largest >= 0x1p-60f && largest <= 0x1p60f;
    margin_per_reach = sound ? kMarginPerReach : kInfinity;
  }
};

/// Whether the planes show that the line misses everything in the lane's box. Adds the planes looked at to `tested`.
/// Comparisons are false for NaN, which culls nothing.
inline bool planes_miss(const Node& node, int lane, const CullPlane* planes, int count, const CullRay& ray,
                        std::uint64_t& tested) {
  float lo[3], hi[3], from_centre[3], reach = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float l = node.plane[axis][lane], h = node.plane[axis + 3][lane];
    lo[axis] = l - ray.origin[axis];
    hi[axis] = h - ray.origin[axis];
    from_centre[axis] = ray.origin[axis] - plane_centre(l, h);
    reach = std::fmax(reach, std::fmax(std::fabs(lo[axis]), std::fabs(hi[axis])));
  }
  const float margin = ray.margin_per_reach * reach + kLeastMargin;
  float entry = -kInfinity, exit = kInfinity;
  for (int axis = 0; axis < 3; ++axis) {
    if (ray.direction[axis] == 0.0f) continue;   // the box test has seen to it
    const bool down = ray.direction[axis] < 0.0f;
    const float near = (down ? hi[axis] + margin : lo[axis] - margin) * ray.inverse[axis];
    const float far = (down ? lo[axis] - margin : hi[axis] + margin) * ray.inverse[axis];
    entry = near > entry ? near : entry;
    exit = far < exit ? far : exit;
  }
  for (int i = 0; i < count; ++i) {
    const float* const n = planes[i].normal;
    const float height = n[0] * from_centre[0] + n[1] * from_centre[1] + n[2] * from_centre[2] - planes[i].distance;
    const float outside = height - margin;   // of the origin
    const float along = n[0] * ray.direction[0] + n[1] * ray.direction[1] + n[2] * ray.direction[2];
    ++tested;
    if (along < 0.0f) {   // seen from the front: the line comes in
      const float in = outside / -along;
      entry = in > entry ? in : entry;
    } else if (along > 0.0f) {   // from the back: it goes out, behind the origin or not
      const float out = -outside / along;
      exit = out < exit ? out : exit;
    } else if (outside > 0.0f) {
      return true;
    }
    if (entry > exit) return true;
  }
  return false;
}

/// Of the child lanes in `mask`, whose boxes were hit, those that no plane shows to be missed.
[[gnu::noinline]] inline std::uint32_t cull_lanes(const Node& node, const CullPlane* planes, const CullRay& ray,
                                                  std::uint32_t mask, TestCounts& counts) {
  const CullPlane* first = planes + node.first_plane;
  std::uint64_t tested = 0;
  for (int lane = 0; lane < node.count; ++lane) {
    const int count = plane_count(node, lane);
    if ((mask >> lane & 1u) != 0 && count > 0 && planes_miss(node, lane, first, count, ray, tested)) {
      mask &= ~(1u << lane);
      ++counts.culled;
    }
    first += count;
  }
  counts.plane += tested;
  return mask;
}

}  // namespace carousel::accel
