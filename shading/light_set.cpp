#include "shading/light_set.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "shading/luminance.h"
#include "shading/punctual_light.h"
#include "shading/spawn_point.h"
#include "shading/surface.h"

namespace carousel::shading {

namespace {

/// A shadow ray ends this share of its length before the light, so that the rounding of t' at a grazing or
/// sliver-shaped light does not make the light shadow itself.
constexpr float kShortOfLight = 0.9999f;

float finite_weight(float flux) {
  return flux > 0.0f && flux < kInfinity ? flux : 0.0f;
}

}  // namespace

LightSet::LightSet(const scene::Scene& scene, bool punctual, bool triangles) : scene_(scene), triangles_(scene) {
  std::vector<float> weights;
  weights.reserve(scene.lights.size() + triangles_.all().size());
  float radius = 0;
  if (!scene.lights.empty()) {
    const Aabb bounds = scene.bounds();
    if (!bounds.empty()) radius = 0.5f * glm::length(bounds.extent());
  }
  for (const scene::PunctualLight& light : scene.lights) {
    weights.push_back(punctual ? finite_weight(luminance(punctual_flux(light, radius))) : 0.0f);
  }
  for (const EmissiveTriangle& light : triangles_.all()) weights.push_back(triangles ? finite_weight(light.flux) : 0.0f);
  choice_ = LightChoice(weights);
}

LightSample LightSet::sample(const LightDraw& draw, const Vec3& origin, SpawnOffset offset) const {
  const std::uint32_t index = choice_.choose(draw.choice);
  const float probability = choice_.probability(index);
  if (index >= scene_.lights.size()) {
    return sample_triangle(triangles_.all()[index - scene_.lights.size()], probability, draw.point, origin,
                           offset);
  }
  const PunctualSample light = sample_punctual(scene_.lights[index], origin);
  const bool directional = std::isinf(light.distance);
  return {directional ? light.to_light : scene_.lights[index].position - origin,
          directional ? kInfinity : kShortOfLight, light.to_light, light.irradiance * (1.0f / probability),
          0.0f};
}

LightSample LightSet::sample_triangle(const EmissiveTriangle& light, float probability, const Vec2& u,
                                      const Vec3& origin, SpawnOffset offset) const {
  // Uniform over the triangle, keeping strata compact: E. Heitz, "A low-distortion map between triangle and
  // square", 2019.
  float b1 = u.x, b2 = u.y;
  if (b2 > b1) {
    b1 *= 0.5f;
    b2 -= b1;
  } else {
    b2 *= 0.5f;
    b1 -= b2;
  }
  const TriangleGeometry geometry = triangle_geometry(scene_, light.instance, light.primitive, b1, b2);
  const bool front = glm::dot(geometry.normal, DVec3(origin) - geometry.position) > 0.0;
  const TrianglePoint point = triangle_point(scene_, light.instance, light.primitive, b1, b2);
  if (!emits(*point.material, front) || !(light.area > 0.0f)) return {};

  LightSample s;
  s.direction = spawn_point(geometry, front ? Side::kFront : Side::kBack, offset) - origin;
  const float distance2 = glm::dot(s.direction, s.direction);
  if (!(distance2 > 0.0f)) return {};
  s.tmax = kShortOfLight;
  s.wi = s.direction * (1.0f / std::sqrt(distance2));
  const float cos_light = std::abs(glm::dot(Vec3(geometry.normal), s.wi));
  if (!(cos_light > 0.0f)) return {};
  s.pdf = probability * distance2 / (light.area * cos_light);
  s.radiance = emitted(scene_, point) * (1.0f / s.pdf);
  // The shadow ray ends before the lamp, which would have let some rays pass.
  if (point.material->alpha_mode != scene::AlphaMode::kOpaque) s.radiance *= opacity(scene_, point);
  return s;
}

float LightSet::triangle_pdf(std::uint32_t instance, std::uint32_t primitive, float t,
                             float cos_light) const {
  if (choice_.empty() || !(cos_light > 0.0f)) return 0.0f;
  if (primitive >= scene_.meshes[scene_.instances[instance].mesh.value].triangle_count()) return 0.0f;   // a sphere
  const std::uint32_t index = triangles_.index_of(scene_, instance, primitive);
  const float area = triangles_.all()[index].area;
  if (!(area > 0.0f)) return 0.0f;
  const float probability = choice_.probability(static_cast<std::uint32_t>(scene_.lights.size()) + index);
  return probability * t * t / (area * cos_light);
}

}  // namespace carousel::shading
