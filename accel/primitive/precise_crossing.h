#pragma once

#include <algorithm>
#include <cstddef>

#include "accel/primitive/watertight.h"
#include "accel/structure/node.h"

namespace carousel::accel {

/// Where a ray's line meets the plane of a triangle.
struct PreciseCrossing {
  double t;
  double second, third;  ///< weights of the second and third corner
};

/// The answer for a triangle that the watertight test in float has found to be met: it decides in float, and only its
/// distance and weights are computed here, by the same steps in double. So a surface stays closed as the float decides
/// it, and t is as exact as a float can be. t lies between the distances of the corners, and the weights within the
/// triangle, also if the line passes it by as little as the float cannot tell. docs/accuracy.md derives the bound of
/// the error. Nothing overflows or underflows, whatever the floats. False if the triangle is seen so exactly edge-on
/// that double cannot tell its area from none: the answer in float has to do.
[[gnu::always_inline]] inline bool precise_crossing(const WatertightRay<float>& ray, const TriangleBlock& block,
                                                    std::size_t lane, PreciseCrossing& out) {
  const double dz = ray.direction[2], sx = ray.direction[0] / dz, sy = ray.direction[1] / dz, sz = 1.0 / dz;
  const double origin_x = ray.origin[ray.kx], origin_y = ray.origin[ray.ky], origin_z = ray.origin[ray.kz];
  double x[3], y[3], t[3];
#pragma GCC unroll 3
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& p = block.vertex[k];
    const double z = double{p[ray.kz][lane]} - origin_z;
    x[k] = (double{p[ray.kx][lane]} - origin_x) - sx * z;
    y[k] = (double{p[ray.ky][lane]} - origin_y) - sy * z;
    t[k] = sz * z;
  }
  const double u = x[2] * y[1] - y[2] * x[1], v = x[0] * y[2] - y[0] * x[2], w = x[1] * y[0] - y[1] * x[0];
  const double det = u + (v + w);
  if (det == 0.0) return false;
  const double inverse = 1.0 / det;
  const double at = (u * t[0] + (v * t[1] + w * t[2])) * inverse;
  const double least = std::min(t[0], std::min(t[1], t[2])), most = std::max(t[0], std::max(t[1], t[2]));
  out = {at < least ? least : at > most ? most : at, v * inverse, w * inverse};
  const double first = u * inverse;
  if (first < 0.0 || out.second < 0.0 || out.third < 0.0) [[unlikely]] {
    out.second = std::max(out.second, 0.0);
    out.third = std::max(out.third, 0.0);
    const double sum = std::max(first, 0.0) + (out.second + out.third);  // 1 or more
    out.second /= sum;
    out.third /= sum;
  }
  return true;
}

}  // namespace carousel::accel
