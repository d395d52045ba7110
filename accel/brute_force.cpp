#include "accel/brute_force.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "accel/ray_check.h"
#include "accel/slab.h"
#include "accel/transform.h"

namespace carousel::accel {

namespace {

struct Crossing {
  float t, u, v;
};

// Woop, Benthin, Wald 2013, appendix A, written from the paper for one triangle.
bool watertight_scalar(const Ray& ray, const std::array<Vec3, 3>& p, Crossing& out) {
  const Vec3 d = ray.direction;
  int kz = 0;
  if (std::fabs(d.y) >= std::fabs(d[kz])) kz = 1;
  if (std::fabs(d.z) >= std::fabs(d[kz])) kz = 2;
  int kx = (kz + 1) % 3, ky = (kx + 1) % 3;
  if (d[kz] < 0) std::swap(kx, ky);
  const float sx = d[kx] / d[kz], sy = d[ky] / d[kz], sz = 1.0f / d[kz];
  float x[3], y[3], z[3];
  for (int i = 0; i < 3; ++i) {
    const Vec3 a = p[i] - ray.origin;
    x[i] = a[kx] - sx * a[kz];
    y[i] = a[ky] - sy * a[kz];
    z[i] = sz * a[kz];
  }
  float u = x[2] * y[1] - y[2] * x[1];
  float v = x[0] * y[2] - y[0] * x[2];
  float w = x[1] * y[0] - y[1] * x[0];
  if (u == 0 || v == 0 || w == 0) {
    u = float(double(x[2]) * y[1] - double(y[2]) * x[1]);
    v = float(double(x[0]) * y[2] - double(y[0]) * x[2]);
    w = float(double(x[1]) * y[0] - double(y[1]) * x[0]);
  }
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
  const float det = u + (v + w);
  if (det == 0) return false;
  const float inverse = 1.0f / det;
  out = {(u * z[0] + (v * z[1] + w * z[2])) * inverse, v * inverse, w * inverse};
  return out.t >= ray.tmin && out.t <= std::numeric_limits<float>::max();
}

Aabb box_of(const std::array<Vec3, 3>& p) {
  Aabb box;
  for (const Vec3& v : p) box.extend(v);
  return box;
}

}  // namespace

Hit brute_force(const scene::Scene& scene, const RayRequest& request, const AccuracyConfig& accuracy) {
  Hit best;
  if (!valid(request.ray)) return best;
  best.t = request.ray.tmax;
  const SlabRay world_slab(request.ray);
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Affine& m = scene.instances[i].world_from_model;
    const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh.value];
    InstanceTransform transform;
    const bool baked = !make_transform(m, transform, accuracy.transform);
    if (baked) transform = InstanceTransform{};
    const auto triangle = [&](std::uint32_t primitive) {
      std::array<Vec3, 3> p;
      for (std::uint32_t k = 0; k < 3; ++k) {
        p[k] = mesh.positions[mesh.indices[3 * primitive + k]];
        if (baked) p[k] = m.linear * p[k] + m.translation;
      }
      return p;
    };
    Aabb model_box;
    for (std::uint32_t primitive = 0; primitive < mesh.triangle_count(); ++primitive)
      model_box.extend(box_of(triangle(primitive)));
    const Aabb world = baked ? model_box : world_box(m, model_box, accuracy.transform);
    float instance_entry;
    if (world.empty() || !slab(world_slab, world, request.ray.tmax, instance_entry)) continue;
    const Ray ray = transform.to_model(request.ray);
    const SlabRay model_slab(ray);
    for (std::uint32_t primitive = 0; primitive < mesh.triangle_count(); ++primitive) {
      const std::array<Vec3, 3> p = triangle(primitive);
      Crossing crossing;
      float entry;
      if (!watertight_scalar(ray, p, crossing)) continue;
      if (!slab(model_slab, box_of(p), request.ray.tmax, entry)) continue;
      const float t = std::max(std::max(crossing.t, entry), instance_entry);
      // Instances and primitives are visited in rising order, so an equal t never replaces an earlier hit.
      if (t < best.t || (t == best.t && !best.valid())) best = {t, crossing.u, crossing.v, i, primitive};
    }
  }
  if (!best.valid()) best = Hit{};
  return best;
}

}  // namespace carousel::accel
