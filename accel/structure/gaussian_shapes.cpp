#include "accel/structure/gaussian_shapes.h"

#include <algorithm>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "core/numeric/exponential.h"

namespace carousel::accel {

GaussianShapes::GaussianShapes(const scene::GaussianCloud& cloud)
    : triangles_(cloud.geometry == GaussiansConfig::Geometry::kTriangles), opaque_below_(cloud.opaque_below) {
  shapes_.reserve(cloud.shapes.size());
  for (const scene::Gaussian& one : cloud.shapes)
    shapes_.push_back(
        {glm::inverse(DMat3(one.spread) * double{one.reach}), one.mean, one.color, one.opacity, one.reach});
}

bool GaussianShapes::respond(const Ray& ray, float tmin, const Hit& shape, Hit& hit) const {
  const Shape& one = shapes_[number_of(shape)];
  const DVec3 origin = one.unit_from_world * (DVec3(ray.origin) - DVec3(one.mean));
  const DVec3 direction = one.unit_from_world * DVec3(ray.direction);
  const double length = glm::dot(direction, direction);
  const DVec3 moment = glm::cross(origin, direction);
  const double distance = glm::dot(moment, moment) / length;  // squared; without a difference of like numbers
  const auto t = static_cast<float>(-glm::dot(origin, direction) / length);
  if (!(distance <= 1) || !(t >= tmin && t >= shape.t && t <= ray.tmax)) return false;
  hit = shape;
  hit.t = t;
  hit.u = static_cast<float>(distance * (double{one.reach} * double{one.reach}));
  hit.v = 0;
  if (triangles_) hit.primitive -= hit.primitive % scene::kProxyTriangles;
  return true;
}

float GaussianShapes::alpha(const Hit& hit) const {
  constexpr float kMost = 0.99f;
  return std::min(kMost, shapes_[number_of(hit)].opacity * exp_float(-0.5f * hit.u));
}

std::shared_ptr<const GaussianShapes> gaussian_shapes(const scene::GaussianCloud& cloud) {
  return cloud.empty() ? nullptr : std::make_shared<const GaussianShapes>(cloud);
}

}  // namespace carousel::accel
