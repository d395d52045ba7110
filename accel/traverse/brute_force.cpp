#include "accel/traverse/brute_force.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "accel/box/double_slab.h"
#include "accel/box/slab.h"
#include "accel/exact/exact_triangle.h"
#include "accel/structure/sphere.h"
#include "accel/transform/transform.h"
#include "accel/traverse/ray_check.h"
#include "core/numeric/octahedral.h"
#include "scene/model/opacity.h"

namespace carousel::accel {

namespace {

struct Crossing {
  float t, u, v;
};
using Corners = std::array<Vec3, 3>;

// Woop, Benthin, Wald 2013, appendix A, written from the paper for one triangle; T is the arithmetic.
template <class T>
struct Sheared {
  T x[3], y[3], z[3];  ///< corners seen from the origin along the ray; z times the shear is t
  T u, v, w;           ///< the edges' values

  Sheared(const Ray& ray, const Corners& p) {
    const Vec3 d = ray.direction;
    int kz = 0;
    if (std::fabs(d.y) >= std::fabs(d[kz])) kz = 1;
    if (std::fabs(d.z) >= std::fabs(d[kz])) kz = 2;
    int kx = (kz + 1) % 3, ky = (kx + 1) % 3;
    if (d[kz] < 0) std::swap(kx, ky);
    const T sx = T{d[kx]} / T{d[kz]}, sy = T{d[ky]} / T{d[kz]}, sz = T{1} / T{d[kz]};
    for (std::size_t i = 0; i < 3; ++i) {
      const T a[3] = {T{p[i].x} - ray.origin.x, T{p[i].y} - ray.origin.y, T{p[i].z} - ray.origin.z};
      x[i] = a[kx] - sx * a[kz];
      y[i] = a[ky] - sy * a[kz];
      z[i] = sz * a[kz];
    }
    u = x[2] * y[1] - y[2] * x[1];
    v = x[0] * y[2] - y[0] * x[2];
    w = x[1] * y[0] - y[1] * x[0];
  }

  T t_times_det() const { return u * z[0] + (v * z[1] + w * z[2]); }
};

template <class T>
bool signs_differ(T u, T v, T w) {
  return (u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0);
}

template <class T>
bool watertight_scalar(const Ray& ray, const Corners& p, Crossing& out) {
  Sheared<T> s(ray, p);
  if (std::is_same_v<T, float> && (s.u == 0 || s.v == 0 || s.w == 0)) {
    const auto &x = s.x, &y = s.y;
    const double u = double(x[2]) * y[1] - double(y[2]) * x[1];
    const double v = double(x[0]) * y[2] - double(y[0]) * x[2];
    const double w = double(x[1]) * y[0] - double(y[1]) * x[0];
    if (signs_differ(u, v, w)) return false;
    s.u = T(u), s.v = T(v), s.w = T(w);
  }
  if (signs_differ(s.u, s.v, s.w)) return false;
  const T det = s.u + (s.v + s.w);
  if (det == 0) return false;
  const T inverse = T{1} / det;
  out = {float(s.t_times_det() * inverse), float(s.v * inverse), float(s.w * inverse)};
  return true;
}

// The distance and the weights in double of a triangle that the float meets.
void refine(const Ray& ray, const Corners& p, Crossing& out) {
  const Sheared<double> s(ray, p);
  const double det = s.u + (s.v + s.w), inverse = 1 / det;
  const bool ahead = out.t >= ray.tmin && out.t <= std::numeric_limits<float>::max();
  if (det != 0) {
    const auto [least, most] = std::minmax({s.z[0], s.z[1], s.z[2]});
    const double t = s.t_times_det() * inverse;
    double weight[3] = {s.u * inverse, s.v * inverse, s.w * inverse};
    if (weight[0] < 0 || weight[1] < 0 || weight[2] < 0) {
      for (double& part : weight) part = std::max(part, 0.0);
      const double sum = weight[0] + (weight[1] + weight[2]);
      for (double& part : weight) part /= sum;
    }
    out = {float(t < least ? least : t > most ? most : t), float(weight[1]), float(weight[2])};
  }
  if (ahead) out.t = std::clamp(out.t, ray.tmin, std::numeric_limits<float>::max());
}

// Möller, Trumbore 1997, section 2.
bool moller_trumbore_scalar(const Ray& ray, const Corners& p, Crossing& out) {
  const auto cross = [](const Vec3& a, const Vec3& b) {
    return Vec3{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  };
  const auto dot = [](const Vec3& a, const Vec3& b) { return a.x * b.x + (a.y * b.y + a.z * b.z); };
  const Vec3 e1 = p[1] - p[0], e2 = p[2] - p[0], across = cross(ray.direction, e2);
  const float inverse = 1.0f / dot(e1, across);
  const Vec3 s = ray.origin - p[0], q = cross(s, e1);
  out = {dot(e2, q) * inverse, dot(s, across) * inverse, dot(ray.direction, q) * inverse};
  return out.u >= 0 && out.v >= 0 && out.u + out.v <= 1;
}

bool crosses(TriangleLevel level, const Ray& ray, const Corners& p, Crossing& out) {
  switch (level) {
    case TriangleLevel::kFast:
      return moller_trumbore_scalar(ray, p, out);
    case TriangleLevel::kWatertight:
      if (!watertight_scalar<float>(ray, p, out) || std::isnan(out.t)) return false;
      refine(ray, p, out);
      return true;
    case TriangleLevel::kDouble:
      return watertight_scalar<double>(ray, p, out);
    case TriangleLevel::kExact:
      break;
  }
  NearestCrossing crossing;
  if (!exact_triangle(ray, p, crossing)) return false;
  out = {crossing.t, crossing.u, crossing.v};
  return true;
}

/// True if the triangle shows its front; computed independently of the product's function.
bool shows_front(const Ray& ray, const Corners& p) {
  using Wide = long double;
  const auto edge = [&](std::size_t k, int axis) { return Wide{p[k][axis]} - Wide{p[0][axis]}; };
  Wide sum = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    sum += Wide{ray.direction[i]} * (edge(1, j) * edge(2, k) - edge(1, k) * edge(2, j));
  }
  return sum < 0;
}

Aabb box_of(const Corners& p) {
  Aabb box;
  for (const Vec3& v : p) box.extend(v);
  return box;
}

// Slab is SlabRay or DoubleSlabRay.
template <class Slab>
Hit every_primitive(const scene::Scene& scene, const RayRequest& request, const AccuracyConfig& accuracy,
                    const AnyHit* any_hit, std::vector<Hit>* all = nullptr) {
  Hit best;
  if (!valid(request.ray)) return best;
  best.t = request.ray.tmax;
  const float widening = far_widening(accuracy.box);
  const scene::Opacity opacity(scene);
  const Slab world_slab(request.ray, widening);
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Affine& m = scene.instances[i].world_from_model;
    const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh.value];
    InstanceTransform transform;
    const bool baked = !make_transform(m, transform, accuracy.transform);
    if (baked) transform = InstanceTransform{};
    const auto accepts = [&](std::uint32_t primitive, bool front, float u, float v) {
      if ((request.tag.flags & (front ? kRayCullFront : kRayCullBack)) != 0) return false;
      const bool calls_any_hit = primitive < mesh.triangle_count()
                                     ? opacity.may_be_non_opaque(mesh, primitive)
                                     : opacity.may_be_non_opaque(mesh.spheres[primitive - mesh.triangle_count()]);
      return !calls_any_hit || any_hit == nullptr || (request.tag.flags & kRayForceOpaque) != 0 ||
             any_hit->accepts(request.ray, i, primitive, u, v);
    };
    const auto lower = [&](float t, float u, float v, std::uint32_t primitive) {
      if (all != nullptr) {
        if (t <= request.ray.tmax) all->push_back({t, u, v, i, primitive});
        return;
      }
      // Instances and primitives are visited in rising order, so an equal t never replaces an earlier hit.
      if (t < best.t || (t == best.t && !best.valid())) best = {t, u, v, i, primitive};
    };
    const auto triangle = [&](std::uint32_t primitive) {
      Corners p;
      for (std::uint32_t k = 0; k < 3; ++k) {
        p[k] = mesh.positions[mesh.indices[3 * primitive + k]];
        if (baked) p[k] = m.linear * p[k] + m.translation;
      }
      return p;
    };
    Aabb model_box;
    for (std::uint32_t primitive = 0; primitive < mesh.triangle_count(); ++primitive)
      model_box.extend(box_of(triangle(primitive)));
    for (const scene::Sphere& sphere : mesh.spheres) model_box.extend(sphere_box(sphere.center, sphere.radius));
    const Aabb world = baked ? model_box : world_box(m, model_box, accuracy.transform);
    float instance_entry;
    if (world.empty() || !slab(world_slab, world, request.ray.tmax, instance_entry)) continue;
    const Ray ray = transform.to_model(request.ray);
    const Slab model_slab(ray, widening);
    for (std::uint32_t primitive = 0; primitive < mesh.triangle_count(); ++primitive) {
      const Corners p = triangle(primitive);
      Crossing crossing;
      float entry;
      if (!crosses(accuracy.triangle, ray, p, crossing)) continue;
      if (!(crossing.t >= ray.tmin && crossing.t <= std::numeric_limits<float>::max())) continue;
      if (!slab(model_slab, box_of(p), request.ray.tmax, entry)) continue;
      if (!accepts(primitive, shows_front(ray, p), crossing.u, crossing.v)) continue;
      lower(std::max({crossing.t, entry, instance_entry}), crossing.u, crossing.v, primitive);
    }
    for (std::uint32_t s = 0; s < mesh.spheres.size(); ++s) {
      const scene::Sphere& sphere = mesh.spheres[s];
      const std::uint32_t primitive = static_cast<std::uint32_t>(mesh.triangle_count()) + s;
      SphereCrossing crossing;
      float entry;
      if (!cross_sphere(ray.origin, ray.direction, sphere.center, sphere.radius, crossing)) continue;
      if (!slab(model_slab, sphere_box(sphere.center, sphere.radius), request.ray.tmax, entry)) continue;
      for (int k = 0; k < 2; ++k) {
        const float t = static_cast<float>(crossing.t[k]);
        const Vec2 uv = octahedral(crossing.normal[k]);
        if (!(t >= ray.tmin && t <= std::numeric_limits<float>::max())) continue;
        if (accepts(primitive, k == 0, uv.x, uv.y)) lower(std::max({t, entry, instance_entry}), uv.x, uv.y, primitive);
      }
    }
  }
  if (!best.valid()) best = Hit{};
  return best;
}

}  // namespace

Hit brute_force(const scene::Scene& scene, const RayRequest& request, const AccuracyConfig& accuracy,
                const AnyHit* any_hit) {
  return accuracy.box == BoxLevel::kDouble ? every_primitive<DoubleSlabRay>(scene, request, accuracy, any_hit)
                                           : every_primitive<SlabRay>(scene, request, accuracy, any_hit);
}

std::vector<Hit> brute_force_all(const scene::Scene& scene, const RayRequest& request, const AccuracyConfig& accuracy,
                                 const AnyHit* any_hit) {
  std::vector<Hit> all;
  if (accuracy.box == BoxLevel::kDouble)
    every_primitive<DoubleSlabRay>(scene, request, accuracy, any_hit, &all);
  else
    every_primitive<SlabRay>(scene, request, accuracy, any_hit, &all);
  return all;
}

}  // namespace carousel::accel
