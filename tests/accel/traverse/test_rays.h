#pragma once

#include <array>
#include <cstdint>
#include <random>

#include <glm/geometric.hpp>

#include "accel/traverse/reference_tracer.h"
#include "core/types/ray.h"
#include "core/types/workload.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// Numbers that are the same with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>((engine_() >> 32) % n); }
  float uniform() { return static_cast<float>(engine_() >> 40) * 0x1p-24f; }
  float uniform(float lo, float hi) { return lo + (hi - lo) * uniform(); }
  Vec3 in_box(const Vec3& lo, const Vec3& hi) {
    const float x = uniform(lo.x, hi.x), y = uniform(lo.y, hi.y), z = uniform(lo.z, hi.z);
    return {x, y, z};
  }
  /// Any bit pattern: NaN, infinities, denormals, zeros of both signs.
  float any_bits() { return std::bit_cast<float>(static_cast<std::uint32_t>(engine_() >> 32)); }

 private:
  std::mt19937_64 engine_;
};

inline RayRequest ray_to(const Vec3& from, const Vec3& direction, float tmin = 0, float tmax = kInfinity,
                         RayKind kind = RayKind::kCamera) {
  RayRequest request;
  request.ray = {from, tmin, direction, tmax};
  request.tag.kind = kind;
  return request;
}

/// World positions of a random triangle's corners, or of three points of a sphere.
inline std::array<Vec3, 3> random_triangle(const scene::Scene& scene, Random& random) {
  const scene::Instance& instance = scene.instances[random.below(static_cast<std::uint32_t>(scene.instances.size()))];
  const scene::Mesh& mesh = scene.meshes[instance.mesh.value];
  const std::uint32_t primitive = random.below(static_cast<std::uint32_t>(mesh.triangle_count() + mesh.spheres.size()));
  const scene::Sphere* const sphere =
      primitive < mesh.triangle_count() ? nullptr : &mesh.spheres[primitive - mesh.triangle_count()];
  std::array<Vec3, 3> p;
  for (std::uint32_t k = 0; k < 3; ++k) {
    if (sphere != nullptr)
      p[k] = sphere->center + sphere->radius * glm::normalize(random.in_box(Vec3{-1}, Vec3{1}) + Vec3{1e-3f});
    else
      p[k] = mesh.positions[mesh.indices[3 * primitive + k]];
    p[k] = instance.world_from_model.linear * p[k] + instance.world_from_model.translation;
  }
  return p;
}

/// Rays with origins and directions of any magnitude, far beyond what a tree is built for.
inline RayBatch rays_of_any_bits(int count, std::uint64_t seed) {
  Random random(seed);
  RayBatch rays;
  for (int i = 0; i < count; ++i) {
    RayRequest r = ray_to(random.in_box(Vec3{-9}, Vec3{9}), random.in_box(Vec3{-1}, Vec3{1}));
    if (i % 2) r.ray.origin[static_cast<int>(random.below(3))] = random.any_bits();
    if (i % 3) r.ray.direction[static_cast<int>(random.below(3))] = random.any_bits();
    if (i % 5 == 0) r.ray.tmin = random.any_bits();
    if (i % 7 == 0) r.ray.tmax = random.any_bits();
    rays.push_back(r);
  }
  return rays;
}

/// The mix of rays that finds faults: through the bounds, aimed at edges and vertices, along the axes from
/// planes that boxes lie on, from the surface, cut short by tmin and tmax; every eighth is a shadow ray.
inline RayBatch mixed_rays(const scene::Scene& scene, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  const Aabb bounds = scene.bounds();
  const Vec3 lo = bounds.lo - bounds.extent(), hi = bounds.hi + bounds.extent();
  RayBatch rays;
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<Vec3, 3> p = random_triangle(scene, random);
    const Vec3 from = random.in_box(lo, hi);
    RayRequest r = ray_to(from, random.in_box(bounds.lo, bounds.hi) - from);
    switch (i % 6) {
      case 0:
        break;
      case 1:
        r.ray.direction = p[0] - from;
        break;  // at a vertex
      case 2:
        r.ray.direction = p[0] + random.uniform() * (p[1] - p[0]) - from;
        break;   // at an edge
      case 3: {  // along an axis
        const int axis = static_cast<int>(random.below(3));
        r.ray.origin = p[0];
        r.ray.origin[axis] = from[axis];
        r.ray.direction = Vec3{random.below(2) ? 0.0f : -0.0f};
        r.ray.direction[axis] = from[axis] > bounds.centre()[axis] ? -1.0f : 1.0f;
        break;
      }
      case 4:  // from a surface
        r.ray.origin = (p[0] + p[1] + p[2]) * (1.0f / 3);
        r.ray.direction = from - r.ray.origin;
        break;
      case 5:  // a piece of a ray
        r.ray.tmin = random.uniform();
        r.ray.tmax = r.ray.tmin + random.uniform();
        break;
    }
    if (r.ray.direction == Vec3{0}) r.ray.direction.x = 1;
    if (i % 8 == 7) r.tag.kind = RayKind::kShadow;
    rays.push_back(r);
  }
  return rays;
}

/// The rays of mixed_rays() without an end and from the start: at the ends of a range another tracer rounds otherwise.
inline RayBatch whole_rays(const scene::Scene& scene, std::size_t count, std::uint64_t seed) {
  RayBatch rays = mixed_rays(scene, count, seed);
  for (RayRequest& r : rays) {
    r.ray.tmin = 0;
    r.ray.tmax = kInfinity;
    r.tag.kind = RayKind::kCamera;
  }
  return rays;
}

inline HitBatch trace(const Accel& accel, const RayBatch& rays) {
  HitBatch hits;
  IntersectionCounts counts;
  trace_depth_first(accel, rays, hits, counts);
  return hits;
}

inline Hit trace_one(const Accel& accel, const RayRequest& ray) {
  return trace(accel, {ray})[0].hit;
}

}  // namespace carousel::accel
