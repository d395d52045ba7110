#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "tests/accel/traverse/test_rays.h"

namespace carousel::accel {

inline Vec3 some_ulps_off(Vec3 v, Random& random) {
  for (int axis = 0; axis < 3; ++axis)
    for (std::uint32_t steps = random.below(4); steps > 0; --steps)
      v[axis] = std::nextafter(v[axis], random.below(2) ? kInfinity : -kInfinity);
  return v;
}

/// Rays that planes are most likely to lose: at edges and vertices of triangles to an ulp or so, in the triangles'
/// planes, along axes, from on the surface, near by and from afar.
inline RayBatch plane_grazing_rays(const scene::Scene& scene, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  const Aabb bounds = scene.bounds();
  const float size = glm::length(bounds.extent());
  RayBatch rays;
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<Vec3, 3> p = random_triangle(scene, random);
    const float along = random.uniform();
    const Vec3 edge = p[0] + along * (p[1] - p[0]);
    const Vec3 away = random.in_box(Vec3(-1), Vec3(1));
    Vec3 from = edge + away * (random.below(2) ? size * std::exp2(random.uniform(-8, 10)) : glm::length(p[1] - p[0])),
         to = edge;
    switch (random.below(6)) {
      case 0:
        to = p[0];
        break;
      case 1:
        break;
      case 2:  // in the triangle's plane, past a corner or through the middle
        from = p[0] + random.uniform(-9, 9) * (p[1] - p[0]) + random.uniform(-9, 9) * (p[2] - p[0]);
        break;
      case 3: {  // along an axis
        const int axis = static_cast<int>(random.below(3));
        from = to;
        from[axis] += (random.below(2) ? 1 : -1) * size * random.uniform();
        break;
      }
      case 4:  // off the surface, or across it
        from = edge;
        to = edge + away;
        break;
      case 5:  // along an edge and on
        from = p[0] + random.uniform(-9, 0) * (p[1] - p[0]);
        to = p[1];
        break;
    }
    RayRequest r = ray_to(some_ulps_off(from, random), {});
    r.ray.direction = some_ulps_off(to - r.ray.origin, random);
    if (random.below(4) == 0) r.ray.direction *= std::exp2(random.uniform(-20, 20));
    if (random.below(8) == 0) {
      r.ray.tmin = random.uniform();
      r.ray.tmax = r.ray.tmin + random.uniform();
    }
    if (r.ray.direction == Vec3{0}) r.ray.direction.x = 1;
    rays.push_back(r);
  }
  return rays;
}

}  // namespace carousel::accel
