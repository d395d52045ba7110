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
//
// Above the instances, where the kernel's ray is another than the one that is tested: accel/line_margin.cpp.
#pragma once

#include <cmath>
#include <cstdint>

#include "accel/cull_plane.h"
#include "accel/node.h"
#include "core/ray.h"

namespace carousel::accel {

/// In distances along an axis from the origin to the far side of the box.
inline constexpr float kMarginPerReach = 0x1p-19f;   // 32 u
inline constexpr float kLeastMargin = 0x1p-70f;

/// A ray as the plane test wants it, in the space of the nodes.
struct CullRay {
  float origin[3], direction[3], inverse[3];
  float margins;   ///< times a node's: 1, or infinity where a margin would not cover what may be lost

  /// Above the instances the kernel's ray is another, whose direction may be up to 2^30 longer or shorter
  /// (accel/line_margin.h).
  CullRay(const float* o, const Vec3& d, bool above_instances) {
    float largest = 0;
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis] = o[axis];
      direction[axis] = d[axis];
      inverse[axis] = 1.0f / d[axis];
      largest = std::fmax(largest, std::fabs(d[axis]));
    }
    // Outside of this n . d or a quotient by it may underflow or overflow: such rays are not culled.
    const float least = above_instances ? 0x1p-30f : 0x1p-60f, most = above_instances ? 0x1p30f : 0x1p60f;
    const bool sound = largest >= least && largest <= most;
    margins = sound ? 1.0f : kInfinity;
  }
};

/// What planes and box leave of the line of a ray in one child. Each bound counts for those after it; comparisons are
/// false for NaN, which cuts nothing off.
class CutLine {
 public:
  CutLine(const Node& node, int lane, const CullRay& ray) : ray_(ray) {
    float reach = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float l = node.plane[axis][lane], h = node.plane[axis + 3][lane];
      lo_[axis] = l - ray.origin[axis];
      hi_[axis] = h - ray.origin[axis];
      from_centre_[axis] = ray.origin[axis] - plane_centre(l, h);
      reach = std::fmax(reach, std::fmax(std::fabs(lo_[axis]), std::fabs(hi_[axis])));
    }
    margin_ = ray.margins * (node.margin_per_reach * reach + node.least_margin);
  }

  /// By the box, each face moved out.
  void cut_by_box() {
    for (int axis = 0; axis < 3; ++axis) {
      if (ray_.direction[axis] == 0.0f) continue;   // the box test sees to it
      const bool down = ray_.direction[axis] < 0.0f;
      const float near = (down ? hi_[axis] + margin_ : lo_[axis] - margin_) * ray_.inverse[axis];
      const float far = (down ? lo_[axis] - margin_ : hi_[axis] + margin_) * ray_.inverse[axis];
      entry_ = near > entry_ ? near : entry_;
      exit_ = far < exit_ ? far : exit_;
    }
  }

  /// By one plane after the other, until nothing is left. Adds the planes looked at to `tested`.
  void cut_by_planes(const CullPlane* planes, int count, std::uint64_t& tested) {
    for (int i = 0; i < count && !empty(); ++i) {
      const float* const n = planes[i].normal;
      const float height = n[0] * from_centre_[0] + n[1] * from_centre_[1] + n[2] * from_centre_[2] - planes[i].distance;
      const float outside = height - margin_;   // of the origin
      const float along = n[0] * ray_.direction[0] + n[1] * ray_.direction[1] + n[2] * ray_.direction[2];
      ++tested;
      if (along < 0.0f) {   // seen from the front: the line comes in
        const float in = outside / -along;
        entry_ = in > entry_ ? in : entry_;
      } else if (along > 0.0f) {   // from the back: it goes out, behind the origin or not
        const float out = -outside / along;
        exit_ = out < exit_ ? out : exit_;
      } else if (outside > 0.0f) {   // along it
        entry_ = kInfinity;
        exit_ = -kInfinity;
      }
    }
  }

  /// The line misses everything that stands in the child.
  bool empty() const { return entry_ > exit_; }

 private:
  const CullRay& ray_;
  float lo_[3], hi_[3], from_centre_[3], margin_;
  float entry_ = -kInfinity, exit_ = kInfinity;
};

}  // namespace carousel::accel
