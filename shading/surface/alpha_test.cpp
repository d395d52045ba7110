#include "shading/surface/alpha_test.h"

#include <bit>

#include "core/numeric/rng.h"
#include "scene/model/opacity.h"
#include "shading/surface/surface.h"

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
  // A ray meets a sphere twice under the same primitive number; the position tells the two hits apart.
  const bool sphere = point.mesh->positions.empty();
  const std::uint32_t meeting =
      sphere ? std::bit_cast<std::uint32_t>(u) ^ 0x9e3779b9u * std::bit_cast<std::uint32_t>(v) : 0;
  return blended >= 1.0f - scene::kAlphaTolerance || blend_chance(ray, instance, primitive ^ meeting) < blended;
}

}  // namespace carousel::shading
