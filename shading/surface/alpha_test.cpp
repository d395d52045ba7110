#include "shading/surface/alpha_test.h"

#include <bit>

#include <glm/geometric.hpp>

#include "core/numeric/rng.h"
#include "scene/model/opacity.h"
#include "shading/surface/surface.h"
#include "shading/surface/triangle_geometry.h"

namespace carousel::shading {

float blend_chance(const Ray& ray, std::uint32_t instance, std::uint32_t primitive) {
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  const Vec3 &o = ray.origin, &d = ray.direction;
  const PhiloxCounter first = philox4x32({bits(o.x), bits(o.y), bits(o.z), instance}, {bits(d.x), bits(d.y)});
  return unit_float(philox4x32({first[0], first[1], first[2], primitive}, {first[3], bits(d.z)})[0]);
}

bool AlphaTest::accepts(const Ray& ray, std::uint32_t instance, std::uint32_t primitive, float u, float v) const {
  const TrianglePoint point = triangle_point(scene_, instance, primitive, u, v);
  switch (point.material->alpha_mode) {
    case scene::AlphaMode::kOpaque:
      return true;
    case scene::AlphaMode::kMask:
      return alpha(scene_, point) >= point.material->alpha_cutoff - scene::kAlphaTolerance;
    case scene::AlphaMode::kBlend:
      break;
  }
  const float blended = alpha(scene_, point);
  // A ray meets a sphere twice under the same primitive number. The side tells the two hits apart: unlike the position,
  // it is the same at every level of accuracy.
  const bool sphere = primitive >= point.mesh->triangle_count();
  const bool back =
      sphere && glm::dot(triangle_geometry(scene_, instance, primitive, u, v).normal, DVec3(ray.direction)) > 0;
  const std::uint32_t meeting = back ? 0x9e3779b9u : 0;
  return blended >= 1.0f - scene::kAlphaTolerance || blend_chance(ray, instance, primitive ^ meeting) < blended;
}

}  // namespace carousel::shading
