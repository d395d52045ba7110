#pragma once

// The sheen of cloth: A. C. Estevez, C. Kulla, "Production friendly microfacet sheen BRDF", SIGGRAPH course, 2017.
// Equation 2 is the distribution of upright fibres, equations 3 and 4 are their masking. Coordinates are local.

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

#include "core/numeric/exponential.h"
#include "core/types/vec.h"
#include "shading/bsdf/lambert.h"

namespace carousel::shading {

/// Below this roughness the lobe with the fitted masking returns more light than arrives at grazing directions: 26 %
/// more at roughness 0.15 and cosine 0.02.
inline constexpr float kMinSheenRoughness = 0.25f;

inline float charlie_alpha(float roughness) {
  const float r = std::clamp(roughness, kMinSheenRoughness, 1.0f);
  return r * r;
}

inline float charlie_lambda(float cos_theta, float alpha) {
  // Fitted to the distribution's masking at alpha 0 and 1.
  constexpr std::array<float, 5> kSmooth{25.3245f, 3.32435f, 0.16801f, -1.27393f, -4.85967f};
  constexpr std::array<float, 5> kRough{21.5473f, 3.82987f, 0.19823f, -1.97760f, -4.32054f};
  const float t = (1.0f - alpha) * (1.0f - alpha);
  std::array<float, 5> p;
  for (std::size_t i = 0; i < 5; ++i) p[i] = t * kSmooth[i] + (1.0f - t) * kRough[i];
  const auto fit = [&](float x) { return p[0] / (1.0f + p[1] * pow_float(x, p[2])) + p[3] * x + p[4]; };
  const float x = std::clamp(cos_theta, 1e-4f, 1.0f);
  return exp_float(x < 0.5f ? fit(x) : 2.0f * fit(0.5f) - fit(1.0f - x));
}

/// f * cos of `wi`, both above the horizon. Reciprocal in f.
inline float charlie_f_cos(const Vec3& wo, const Vec3& wi, float alpha) {
  const Vec3 sum = wo + wi;
  const float length2 = glm::dot(sum, sum);
  if (!(length2 > 0.0f)) return 0.0f;
  const float cosine = sum.z / std::sqrt(length2);
  const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
  const float inv = 1.0f / alpha;
  const float density = (2.0f + inv) * pow_float(sine, inv) * (0.5f * kInvPi);
  return density / (4.0f * wo.z * (1.0f + charlie_lambda(wo.z, alpha) + charlie_lambda(wi.z, alpha)));
}

}  // namespace carousel::shading
