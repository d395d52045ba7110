#pragma once

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "core/types/vec.h"
#include "scene/model/scene.h"
#include "shading/bsdf/lambert.h"

namespace carousel::shading {

/// Light arriving at `point` from a punctual light, as KHR_lights_punctual defines it.
struct PunctualSample {
  Vec3 to_light{0};    ///< unit
  float distance = 0;  ///< infinite for directional lights
  Vec3 irradiance{0};  ///< on a plane facing the light; zero outside of range or cone
};

inline PunctualSample sample_punctual(const scene::PunctualLight& light, const Vec3& point) {
  using Kind = scene::PunctualLight::Kind;
  if (light.kind == Kind::kDirectional) return {-light.direction, INFINITY, light.intensity};
  const Vec3 d = light.position - point;
  const float distance2 = glm::dot(d, d);
  if (!(distance2 > 0.0f)) return {};
  PunctualSample s;
  s.distance = std::sqrt(distance2);
  s.to_light = d * (1.0f / s.distance);
  float falloff = 1.0f / distance2;
  if (light.range > 0.0f) {
    const float ratio2 = distance2 / (light.range * light.range);
    falloff *= std::clamp(1.0f - ratio2 * ratio2, 0.0f, 1.0f);
  }
  if (light.kind == Kind::kSpot) {
    const float cosine = -glm::dot(s.to_light, light.direction);
    const float width = std::max(light.inner_cone_cos - light.outer_cone_cos, 1e-3f);
    const float cone = std::clamp((cosine - light.outer_cone_cos) / width, 0.0f, 1.0f);
    falloff *= cone * cone;
  }
  s.irradiance = light.intensity * falloff;
  return s;
}

/// Flux, for choosing among lights; `scene_radius` bounds the area that a directional light reaches.
inline Vec3 punctual_flux(const scene::PunctualLight& light, float scene_radius) {
  using Kind = scene::PunctualLight::Kind;
  switch (light.kind) {
    case Kind::kDirectional:
      return light.intensity * (kPi * scene_radius * scene_radius);
    case Kind::kSpot:
      return light.intensity * (2.0f * kPi * (1.0f - 0.5f * (light.inner_cone_cos + light.outer_cone_cos)));
    case Kind::kPoint:
      break;
  }
  return light.intensity * (4.0f * kPi);
}

}  // namespace carousel::shading
