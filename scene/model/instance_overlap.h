#pragma once

#include <cstddef>
#include <vector>

#include <glm/common.hpp>

#include "scene/model/scene.h"

namespace carousel::scene {

/// The number of instances whose boxes a random line through the scene meets on average: the sum of the boxes' surface
/// areas over that of the scene (L. A. Santaló, Integral Geometry and Geometric Probability, 1976, chapter 14: the
/// measure of the lines that meet a convex body is proportional to its surface). Instances that lie in the same place
/// count one each. 0 for a scene without a surface.
inline double instances_met(const Scene& scene) {
  struct Box {
    DVec3 lo{1e300}, hi{-1e300};
    void extend(const DVec3& p) {
      lo = glm::min(lo, p);
      hi = glm::max(hi, p);
    }
    double half_area() const {
      if (lo.x > hi.x) return 0;
      const DVec3 e = hi - lo;
      return e.x * e.y + e.y * e.z + e.z * e.x;
    }
  };
  std::vector<Aabb> models(scene.meshes.size());
  for (std::size_t m = 0; m < models.size(); ++m) {
    for (const Vec3& p : scene.meshes[m].positions) models[m].extend(p);
    for (const Sphere& sphere : scene.meshes[m].spheres) {
      models[m].extend(sphere.center - Vec3(sphere.radius));
      models[m].extend(sphere.center + Vec3(sphere.radius));
    }
  }
  Box all;
  double sum = 0;
  for (const Instance& instance : scene.instances) {
    const Aabb& model = models[instance.mesh.value];
    if (model.empty()) continue;
    Box box;
    for (int corner = 0; corner < 8; ++corner) {
      const DVec3 p((corner & 1 ? model.hi : model.lo).x, (corner & 2 ? model.hi : model.lo).y,
                    (corner & 4 ? model.hi : model.lo).z);
      DVec3 q(instance.world_from_model.translation);
      for (int c = 0; c < 3; ++c) q += p[c] * DVec3(instance.world_from_model.linear[c]);
      box.extend(q);
      all.extend(q);
    }
    sum += box.half_area();
  }
  return all.half_area() > 0 ? sum / all.half_area() : 0;
}

}  // namespace carousel::scene
