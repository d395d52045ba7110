#pragma once

// The GGX microfacet lobe in local coordinates (z is the normal, all directions unit and pointing away from
// the surface). Distribution: B. Walter et al., "Microfacet models for refraction through rough surfaces",
// EGSR 2007. Masking: E. Heitz, "Understanding the masking-shadowing function", JCGT 3(2), 2014.

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "core/types/vec.h"
#include "shading/bsdf/lambert.h"
#include "shading/math/trigonometry.h"

namespace carousel::shading {

/// At this alpha a lobe is as good as a mirror, and its peak (1 / (pi alpha^2)) still far from float's limits.
inline constexpr float kMinAlpha = 1e-3f;

/// From this alpha on a lobe spreads too widely to show an image in it.
inline constexpr float kWideAlpha = 0.3f;

/// The least divisor of a lost share: a mirror loses nothing, and the share would be 0 / 0.
inline constexpr float kLeastShare = 1e-6f;

/// Reflectance of glTF's dielectrics at normal incidence: index of refraction 1.5.
inline constexpr float kDielectricF0 = 0.04f;

/// glTF: alpha is the square of the perceptual roughness.
inline float ggx_alpha(float roughness) {
  return std::max(roughness * roughness, kMinAlpha);
}

/// Density of microfacet normals; written with h.x and h.y, since 1 - h.z^2 cancels for narrow lobes.
inline float ggx_distribution(const Vec3& h, float alpha) {
  const float inv = 1.0f / alpha;
  const float x = h.x * inv, y = h.y * inv;
  const float d = x * x + y * y + h.z * h.z;
  return kInvPi * inv * inv / (d * d);
}

inline float ggx_lambda(const Vec3& w, float alpha) {
  const float tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
  return 0.5f * (std::sqrt(1.0f + alpha * alpha * tan2) - 1.0f);
}

/// F. Schlick, "An inexpensive BRDF model", Eurographics 1994: the weight of the interpolation from F0 to 1.
inline float schlick_weight(float cos_theta) {
  const float m = std::clamp(1.0f - cos_theta, 0.0f, 1.0f);
  return (m * m) * (m * m) * m;
}

/// A microfacet normal visible from `wo`: J. Dupuy, A. Benyoub, "Sampling visible GGX normals with spherical
/// caps", HPG 2023.
inline Vec3 sample_visible_normal(const Vec3& wo, float alpha, const Vec2& u) {
  const Vec3 stretched = glm::normalize(Vec3{wo.x * alpha, wo.y * alpha, wo.z});
  const SinCos phi = sin_cos_turns(u.x);
  const float z = (1.0f - u.y) * (1.0f + stretched.z) - stretched.z;
  const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
  const Vec3 h = Vec3{r * phi.cos, r * phi.sin, z} + stretched;
  return glm::normalize(Vec3{h.x * alpha, h.y * alpha, std::max(h.z, 1e-9f)});
}

/// Specular reflection without its Fresnel term, times the cosine of `wi`; and the density with which
/// sample_visible_normal() and a mirror reflection choose `wi`.
struct GgxValue {
  float f_cos = 0, pdf = 0;
};
inline GgxValue ggx_value(const Vec3& wo, const Vec3& wi, const Vec3& h, float alpha) {
  const float lambda_o = ggx_lambda(wo, alpha);
  const float base = ggx_distribution(h, alpha) / (4.0f * wo.z);
  return {base / (1.0f + lambda_o + ggx_lambda(wi, alpha)), base / (1.0f + lambda_o)};
}

}  // namespace carousel::shading
