#include "accel/planes/oriented_box.h"

#include <cmath>

#include <glm/geometric.hpp>

namespace carousel::accel {

namespace {

/// A box is worth its tests if a ray meets it less often by so much; rays meet a convex body in proportion to its
/// surface.
constexpr double kLeastGain = 1.0 / 16;

}  // namespace

BoxAxes axes_of(const std::vector<CullPlane>& planes) {
  return {normal_of(planes[0]), normal_of(planes[2]), normal_of(planes[4])};
}

void OrientedBoxChoice::offer(const BoxAxes& axes) {
  std::array<CullPlane, 6> planes;
  std::array<double, 3> extent{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t side = 0; side < 2; ++side) {
      CullPlane& plane = planes[2 * i + side];
      plane = {};
      if (!set_normal(side == 0 ? axes[i] : -axes[i], plane)) return;
      plane.distance = child_.distance(plane);
      if (!std::isfinite(plane.distance)) return;
      extent[i] += plane.distance;
    }
    extent[i] /= glm::length(normal_of(planes[2 * i]));
  }
  const double area = extent[0] * extent[1] + extent[1] * extent[2] + extent[2] * extent[0];
  if (area_ > 0 && !(area < area_)) return;
  area_ = area;
  best_ = planes;
}

void OrientedBoxChoice::offer_triangles(const std::vector<Vec3>& points) {
  for (std::size_t i = 0; i < points.size(); i += 3) {
    const std::array<DVec3, 3> p{DVec3(points[i]), DVec3(points[i + 1]), DVec3(points[i + 2])};
    const DVec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    for (std::size_t k = 0; k < 3; ++k) {
      const DVec3 edge = p[(k + 1) % 3] - p[k];
      offer({normal, edge, glm::cross(normal, edge)});
    }
  }
}

std::vector<CullPlane> OrientedBoxChoice::best() const {
  if (!(area_ > 0) || !(area_ < (1 - kLeastGain) * child_.box.half_area())) return {};
  return smallest();
}

}  // namespace carousel::accel
