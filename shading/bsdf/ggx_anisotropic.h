#pragma once

// As ggx.h, with a roughness along x and another along y: B. Burley, "Physically based shading at Disney", SIGGRAPH
// course, 2012; masking as E. Heitz, JCGT 3(2), 2014, section 5.4.

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "core/types/vec.h"
#include "shading/bsdf/lambert.h"
#include "shading/math/trigonometry.h"

namespace carousel::shading {

inline float ggx_distribution(const Vec3& h, const Vec2& alpha) {
  const float x = h.x / alpha.x, y = h.y / alpha.y;
  const float d = x * x + y * y + h.z * h.z;
  return kInvPi / (alpha.x * alpha.y * d * d);
}

inline float ggx_lambda(const Vec3& w, const Vec2& alpha) {
  const float x = w.x * alpha.x, y = w.y * alpha.y;
  return 0.5f * (std::sqrt(1.0f + (x * x + y * y) / (w.z * w.z)) - 1.0f);
}

/// Samples as the isotropic function does.
inline Vec3 sample_visible_normal(const Vec3& wo, const Vec2& alpha, const Vec2& u) {
  const Vec3 stretched = glm::normalize(Vec3{wo.x * alpha.x, wo.y * alpha.y, wo.z});
  const SinCos phi = sin_cos_turns(u.x);
  const float z = (1.0f - u.y) * (1.0f + stretched.z) - stretched.z;
  const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
  const Vec3 h = Vec3{r * phi.cos, r * phi.sin, z} + stretched;
  return glm::normalize(Vec3{h.x * alpha.x, h.y * alpha.y, std::max(h.z, 1e-9f)});
}

}  // namespace carousel::shading
