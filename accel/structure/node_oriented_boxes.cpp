#include "accel/structure/node_oriented_boxes.h"

#include <cmath>

#include <glm/geometric.hpp>

#include "core/numeric/rounding.h"

namespace carousel::accel {

namespace {

constexpr double kFaceSlack = 0x1p-17;       // a part of the reach, see the header
constexpr double kLeastFaceSlack = 0x1p-70;  // where products underflow in the kernel (accel/planes/cull_plane_clip.h)

/// A ray along the normals of a lane's boxes.
struct AlongNormals {
  double from[3], by[3];

  AlongNormals(const NodeOrientedBoxes& boxes, int lane, const DVec3& origin, const DVec3& direction) {
    for (int k = 0; k < 3; ++k) {
      const DVec3 normal(boxes.normal[k][0][lane], boxes.normal[k][1][lane], boxes.normal[k][2][lane]);
      from[k] = glm::dot(normal, origin);
      by[k] = glm::dot(normal, direction);
    }
  }
};

/// Cuts the part of a ray from `in` to `out` by the faces of a lane's box. Comparisons are false for NaN, which comes
/// of infinities: then nothing is cut off.
void cut(const AlongNormals& ray, const float (&lo)[3][kMaxWidth], const float (&hi)[3][kMaxWidth], int lane,
         double& in, double& out) {
  double low[3], high[3], reach = 0;
  for (int k = 0; k < 3; ++k) {
    low[k] = lo[k][lane] - ray.from[k];
    high[k] = hi[k][lane] - ray.from[k];
    reach = std::fmax(reach, std::fmax(std::fabs(low[k]), std::fabs(high[k])));
  }
  const double slack = kFaceSlack * reach + kLeastFaceSlack;
  for (int k = 0; k < 3; ++k) {
    const double first = low[k] - slack, last = high[k] + slack;
    if (ray.by[k] == 0) {
      if (first > 0 || last < 0) out = -std::numeric_limits<double>::infinity();
      continue;
    }
    const double near = (ray.by[k] > 0 ? first : last) / ray.by[k], far = (ray.by[k] > 0 ? last : first) / ray.by[k];
    if (near > in) in = near;
    if (far < out) out = far;
  }
}

}  // namespace

std::uint32_t intersect_oriented_boxes(const NodeOrientedBoxes& boxes, int count, const Vec3& origin,
                                       const Vec3& direction, float tmin, float tmax, float* entry) {
  const DVec3 o(origin), d(direction);
  std::uint32_t mask = 0;
  for (int lane = 0; lane < count; ++lane) {
    const AlongNormals ray(boxes, lane, o, d);
    double in = tmin, out = tmax;
    cut(ray, boxes.box_lo, boxes.box_hi, lane, in, out);
    if (in > out) continue;
    double line_in = -std::numeric_limits<double>::infinity(), line_out = -line_in;
    cut(ray, boxes.lo, boxes.hi, lane, line_in, line_out);
    if (line_in > line_out) continue;
    mask |= 1u << lane;
    entry[lane] = in > tmin ? rounded_down(in) : tmin;
  }
  return mask;
}

}  // namespace carousel::accel
