#pragma once

// Light through a rough boundary: B. Walter, S. Marschner, H. Li, K. Torrance, "Microfacet models for refraction
// through rough surfaces", EGSR 2007, equations 16, 17 and 21. Rays carry radiance over the square of the index of
// refraction here: refraction does not change this quantity, so a path that leaves the volume again needs no factor.

#include <cmath>

#include <glm/geometric.hpp>

#include "core/types/vec.h"
#include "shading/bsdf/ggx_anisotropic.h"

namespace carousel::shading {

/// Without Fresnel's factor: f * |cos of wi|, and the density with which a visible normal and Snell's law choose wi;
/// `h` is the microfacet's normal, h.z > 0. Zero if no microfacet sends light that way.
struct ThroughValue {
  float f_cos = 0, pdf = 0;
  Vec3 h{0, 0, 1};
};

/// `eta` is the index below over that above, not 1; wo.z > 0, wi.z < 0.
inline ThroughValue refracted_value(const Vec3& wo, const Vec3& wi, const Vec2& alpha, float eta) {
  Vec3 h = wo + eta * wi;
  const float length2 = glm::dot(h, h);
  if (!(length2 > 0.0f)) return {};
  h *= (h.z < 0.0f ? -1.0f : 1.0f) / std::sqrt(length2);
  const float oh = glm::dot(wo, h), ih = glm::dot(wi, h);
  if (!(oh > 0.0f) || !(ih < 0.0f)) return {};
  const float lambda_o = ggx_lambda(wo, alpha);
  const float sum = oh + eta * ih;
  const float base = ggx_distribution(h, alpha) * oh / wo.z * (eta * eta * -ih) / (sum * sum);
  return {base / (1.0f + lambda_o + ggx_lambda(wi, alpha)), base / (1.0f + lambda_o), h};
}

/// A thin wall: its two boundaries undo each other's refraction, and light goes on as if reflected and then flipped.
inline ThroughValue thin_value(const Vec3& wo, const Vec3& wi, const Vec2& alpha) {
  const Vec3 mirrored{wi.x, wi.y, -wi.z};
  const Vec3 sum = wo + mirrored;
  const Vec3 h = sum * (1.0f / std::sqrt(glm::dot(sum, sum)));
  const float lambda_o = ggx_lambda(wo, alpha);
  const float base = ggx_distribution(h, alpha) / (4.0f * wo.z);
  return {base / (1.0f + lambda_o + ggx_lambda(mirrored, alpha)), base / (1.0f + lambda_o), h};
}

}  // namespace carousel::shading
