#include "accel/structure/gaussian_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "core/numeric/exponential.h"

namespace carousel::accel {

namespace {

using Basis = std::array<double, scene::higher_harmonics(scene::kMostHarmonicDegree)>;

/// Real spherical harmonics of degree 1 to `degree` in the direction d, of length 1: appendix A of
/// KHR_gaussian_splatting.
Basis basis_of(const DVec3& d, int degree) {
  const double x = d.x, y = d.y, z = d.z, xx = x * x, yy = y * y, zz = z * z;
  Basis out{};
  constexpr double k1 = 0.4886025119029199;
  out[0] = -k1 * y, out[1] = k1 * z, out[2] = -k1 * x;
  if (degree < 2) return out;
  constexpr double k2 = 1.092548430592079;
  out[3] = k2 * x * y, out[4] = -k2 * y * z, out[5] = 0.31539156525252 * (2 * zz - xx - yy);
  out[6] = -k2 * x * z, out[7] = 0.5462742152960395 * (xx - yy);
  if (degree < 3) return out;
  constexpr double k33 = 0.5900435899266435, k31 = 0.4570457994644657;
  out[8] = -k33 * y * (3 * xx - yy), out[9] = 2.890611442640554 * x * y * z;
  out[10] = -k31 * y * (4 * zz - xx - yy), out[11] = 0.3731763325901154 * z * (2 * zz - 3 * xx - 3 * yy);
  out[12] = -k31 * x * (4 * zz - xx - yy), out[13] = 1.445305721320277 * z * (xx - yy);
  out[14] = -k33 * x * (xx - 3 * yy);
  return out;
}

}  // namespace

GaussianShapes::GaussianShapes(const scene::GaussianCloud& cloud)
    : degree_(cloud.degree),
      harmonics_(cloud.harmonics),
      frames_(cloud.degree > 0 ? cloud.frames : std::vector<DMat3>{}),
      triangles_(cloud.geometry == GaussiansConfig::Geometry::kTriangles),
      opaque_below_(cloud.opaque_below) {
  shapes_.reserve(cloud.shapes.size());
  for (const scene::Gaussian& one : cloud.shapes)
    shapes_.push_back(
        {glm::inverse(DMat3(one.spread) * double{one.reach}), one.mean, one.color, one.opacity, one.reach, one.frame});
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

Vec3 GaussianShapes::color(const Hit& hit, const Vec3& direction) const {
  const std::size_t number = number_of(hit);
  const Shape& one = shapes_[number];
  if (degree_ == 0) return glm::max(one.color, Vec3(0));
  DVec3 along(direction);
  if (!frames_.empty()) along = frames_[one.frame] * along;
  const Basis basis = basis_of(along / std::sqrt(glm::dot(along, along)), degree_);
  DVec3 sum(one.color);
  const std::size_t count = scene::higher_harmonics(degree_);
  for (std::size_t k = 0; k < count; ++k) sum += basis[k] * DVec3(harmonics_[number * count + k]);
  return glm::max(Vec3(sum), Vec3(0));
}

std::shared_ptr<const GaussianShapes> gaussian_shapes(const scene::GaussianCloud& cloud) {
  return cloud.empty() ? nullptr : std::make_shared<const GaussianShapes>(cloud);
}

}  // namespace carousel::accel
