#include "shading/lights/light_set.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "core/numeric/octahedral.h"
#include "shading/lights/punctual_light.h"
#include "shading/math/luminance.h"
#include "shading/math/trigonometry.h"
#include "shading/surface/spawn_point.h"
#include "shading/surface/surface.h"

namespace carousel::shading {

namespace {

/// A shadow ray ends this share of its length before the light, so that the rounding of t' at a grazing or
/// sliver-shaped light does not make the light shadow itself.
constexpr float kShortOfLight = 0.9999f;

float finite_weight(float flux) {
  return flux > 0.0f && flux < kInfinity ? flux : 0.0f;
}

}  // namespace

LightSet::LightSet(const scene::Scene& scene, bool punctual, bool primitives, bool sky)
    : scene_(scene), primitives_(scene), sky_(scene.sky.map) {
  std::vector<float> weights;
  weights.reserve(scene.lights.size() + primitives_.all().size() + 1);
  float radius = 0;
  if (!scene.lights.empty() || !sky_.empty()) {
    const Aabb bounds = scene.bounds();
    if (!bounds.empty()) radius = 0.5f * glm::length(bounds.extent());
  }
  for (const scene::PunctualLight& light : scene.lights) {
    weights.push_back(punctual ? finite_weight(luminance(punctual_flux(light, radius))) : 0.0f);
  }
  for (const EmissivePrimitive& light : primitives_.all())
    weights.push_back(primitives ? finite_weight(light.flux) : 0.0f);
  if (sky && !sky_.empty()) weights.push_back(finite_weight(kPi * radius * radius * float(sky_.irradiance())));
  choice_ = LightChoice(weights);
}

LightSample LightSet::sample(const LightDraw& draw, const Vec3& origin, SpawnOffset offset) const {
  const std::uint32_t index = choice_.choose(draw.choice);
  const float probability = choice_.probability(index);
  if (index == sky_index()) return sample_sky(probability, draw.point);
  if (index >= scene_.lights.size()) {
    return sample_primitive(primitives_.all()[index - scene_.lights.size()], probability, draw.point, origin, offset);
  }
  const PunctualSample light = sample_punctual(scene_.lights[index], origin);
  const bool directional = std::isinf(light.distance);
  return {directional ? light.to_light : scene_.lights[index].position - origin,
          directional ? kInfinity : kShortOfLight, light.to_light, light.irradiance * (1.0f / probability), 0.0f};
}

namespace {

/// Uniform over the triangle, keeping strata compact: E. Heitz, "A low-distortion map between triangle and square",
/// 2019.
Vec2 point_of_triangle(const Vec2& u) {
  Vec2 b = u;
  if (b.y > b.x) {
    b.x *= 0.5f;
    b.y -= b.x;
  } else {
    b.y *= 0.5f;
    b.x -= b.y;
  }
  return b;
}

Vec2 point_of_sphere(const Vec2& u) {
  const float z = 1.0f - 2.0f * u.x, r = std::sqrt(std::max(0.0f, 1.0f - z * z));
  const SinCos around = sin_cos_turns(u.y);
  return octahedral({double{r * around.cos}, double{r * around.sin}, double{z}});
}

bool is_sphere(const scene::Scene& scene, std::uint32_t instance, std::uint32_t primitive) {
  return primitive >= scene.meshes[scene.instances[instance].mesh.value].triangle_count();
}

/// The inverse of the density of sphere points: of two that lie opposite each other, the one on the viewer's side is
/// taken.
float sphere_area(const TriangleGeometry& geometry, bool front) {
  return static_cast<float>(geometry.area) * (front ? 0.5f : 1.0f);
}

bool faces(const TriangleGeometry& geometry, const Vec3& origin) {
  return glm::dot(geometry.normal, DVec3(origin) - geometry.position) > 0.0;
}

}  // namespace

LightSample LightSet::sample_primitive(const EmissivePrimitive& light, float probability, const Vec2& u,
                                       const Vec3& origin, SpawnOffset offset) const {
  const bool sphere = is_sphere(scene_, light.instance, light.primitive);
  Vec2 at = sphere ? point_of_sphere(u) : point_of_triangle(u);
  TriangleGeometry geometry = triangle_geometry(scene_, light.instance, light.primitive, at.x, at.y);
  bool front = faces(geometry, origin);
  if (sphere && !front) {
    at = octahedral(-from_octahedral(at.x, at.y));
    geometry = triangle_geometry(scene_, light.instance, light.primitive, at.x, at.y);
    front = faces(geometry, origin);
  }
  const float area = sphere ? sphere_area(geometry, front) : light.area;
  const TrianglePoint point = triangle_point(scene_, light.instance, light.primitive, at.x, at.y);
  if (!emits(*point.material, front) || !(area > 0.0f)) return {};

  LightSample s;
  s.direction = spawn_point(geometry, front ? Side::kFront : Side::kBack, offset) - origin;
  const float distance2 = glm::dot(s.direction, s.direction);
  if (!(distance2 > 0.0f)) return {};
  s.tmax = kShortOfLight;
  s.wi = s.direction * (1.0f / std::sqrt(distance2));
  const float cos_light = std::abs(glm::dot(Vec3(geometry.normal), s.wi));
  if (!(cos_light > 0.0f)) return {};
  s.pdf = probability * distance2 / (area * cos_light);
  s.radiance = emitted(scene_, point) * (1.0f / s.pdf);
  // The shadow ray ends before the light itself, whose opacity would have passed a share of the rays.
  if (point.material->alpha_mode != scene::AlphaMode::kOpaque) s.radiance *= opacity(scene_, point);
  return s;
}

LightSample LightSet::sample_sky(float probability, const Vec2& u) const {
  const SkyLight::Sample sky = sky_.sample(u);
  LightSample s;
  s.direction = s.wi = sky.direction;
  s.tmax = kInfinity;
  s.pdf = probability * sky.pdf;
  s.radiance = sky_.radiance(sky.direction) * (1.0f / s.pdf);
  return s;
}

void LightSet::append_sky_reads(const LightDraw& draw, std::vector<SkyRead>& out) const {
  if (!choice_.empty() && choice_.choose(draw.choice) == sky_index()) sky_.append_reads(draw.point, out);
}

SkyLight::Seen LightSet::sky(const Vec3& direction) const {
  SkyLight::Seen seen = sky_.look(direction);
  seen.pdf *= sky_index() < choice_.size() ? choice_.probability(sky_index()) : 0.0f;
  return seen;
}

float LightSet::primitive_pdf(const Hit& hit, const TriangleGeometry& geometry, bool front, float cos_light) const {
  if (choice_.empty() || !(cos_light > 0.0f)) return 0.0f;
  const std::uint32_t index = primitives_.index_of(scene_, hit.instance, hit.primitive);
  const bool sphere = is_sphere(scene_, hit.instance, hit.primitive);
  const float area = sphere ? sphere_area(geometry, front) : primitives_.all()[index].area;
  if (!(area > 0.0f)) return 0.0f;
  const float probability = choice_.probability(static_cast<std::uint32_t>(scene_.lights.size()) + index);
  return probability * hit.t * hit.t / (area * cos_light);
}

}  // namespace carousel::shading
