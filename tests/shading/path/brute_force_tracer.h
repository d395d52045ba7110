#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/geometric.hpp>

#include "core/types/any_hit.h"
#include "core/types/workload.h"
#include "scene/model/scene.h"

namespace carousel::shading {

/// Tests every ray against every triangle, in world space (Möller, Trumbore 1997). It is slow and simple, and its
/// result depends only on the ray. Ties go to the earlier triangle.
class BruteForceTracer {
 public:
  /// `any_hit`, if not null, is called at every triangle and decides if it stops the ray.
  explicit BruteForceTracer(const scene::Scene& scene, const AnyHit* any_hit = nullptr) : any_hit_(any_hit) {
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
      const scene::Affine& m = scene.instances[i].world_from_model;
      const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh.value];
      for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        Vec3 p[3];
        for (int k = 0; k < 3; ++k) {
          p[k] = m.linear * mesh.positions[mesh.indices[3 * t + std::uint32_t(k)]] + m.translation;
        }
        triangles_.push_back({p[0], p[1] - p[0], p[2] - p[0], i, t});
      }
    }
  }

  Hit trace(const Ray& ray, const RayTag& tag) const {
    Hit best;
    float tmax = ray.tmax;
    for (const Triangle& triangle : triangles_) {
      const Vec3 p = glm::cross(ray.direction, triangle.e2);
      const float det = glm::dot(triangle.e1, p);
      if (det == 0.0f) continue;
      const float inv = 1.0f / det;
      const Vec3 s = ray.origin - triangle.p;
      const float u = glm::dot(s, p) * inv;
      if (!(u >= 0.0f && u <= 1.0f)) continue;
      const Vec3 q = glm::cross(s, triangle.e1);
      const float v = glm::dot(ray.direction, q) * inv;
      if (!(v >= 0.0f && u + v <= 1.0f)) continue;
      const float t = glm::dot(triangle.e2, q) * inv;
      if (!(t > ray.tmin && t < tmax)) continue;
      if (any_hit_ != nullptr && !any_hit_->accepts(ray, triangle.instance, triangle.primitive, u, v)) continue;
      tmax = t;
      best = {t, u, v, triangle.instance, triangle.primitive};
      if (takes_any_hit(tag)) return best;
    }
    return best;
  }

 private:
  struct Triangle {
    Vec3 p, e1, e2;
    std::uint32_t instance, primitive;
  };
  std::vector<Triangle> triangles_;
  const AnyHit* any_hit_;
};

/// Runs a whole frame on the calling thread, in batches of at most `batch` rays.
inline void run_frame(Workload& workload, const BruteForceTracer& tracer, std::size_t batch) {
  RayBatch rays;
  HitBatch hits;
  bool finished = false;
  std::size_t done = 0;  // rays before this one are traced
  while (!finished || done < rays.size()) {
    if (done == rays.size()) {
      rays.clear();
      done = 0;
      finished = workload.generate(WorkerId(0), batch, rays).finished;
    }
    hits.clear();
    while (done < rays.size() && hits.size() < batch) {
      const RayRequest& request = rays[done++];
      hits.push_back({request.ray, tracer.trace(request.ray, request.tag), request.tag});
    }
    workload.shade(WorkerId(0), hits, rays);
  }
}

}  // namespace carousel::shading
