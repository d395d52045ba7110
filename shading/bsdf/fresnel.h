#pragma once

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "core/types/vec.h"

namespace carousel::shading {

/// Reflectance at normal incidence where the index of refraction changes by the factor `eta`.
inline float f0_of_eta(float eta) {
  const float r = (eta - 1.0f) / (eta + 1.0f);
  return r * r;
}

/// Reflection and refraction at a smooth boundary: `eta` is the index behind over the index before. A. J. Fresnel,
/// 1823.
struct Refraction {
  float reflected = 1;  ///< share, unpolarised; 1 beyond the critical angle
  float cosine = 0;     ///< cosine of the refracted direction, positive; 0 beyond the critical angle
  bool total = true;    ///< nothing is refracted
};
inline Refraction refraction(float cos_incident, float eta) {
  const float sine2 = (1.0f - cos_incident * cos_incident) / (eta * eta);  // W. Snell, 1621
  if (!(sine2 < 1.0f)) return {};
  Refraction r;
  r.total = false;
  r.cosine = std::sqrt(1.0f - sine2);
  const float parallel = (eta * cos_incident - r.cosine) / (eta * cos_incident + r.cosine);
  const float perpendicular = (cos_incident - eta * r.cosine) / (cos_incident + eta * r.cosine);
  r.reflected = 0.5f * (parallel * parallel + perpendicular * perpendicular);
  return r;
}

/// The refracted direction of light from `w` behind a boundary of normal `h`, both unit and on one side; `cosine` as
/// above.
inline Vec3 refract(const Vec3& w, const Vec3& h, float eta, float cosine) {
  return (glm::dot(w, h) / eta - cosine) * h - w * (1.0f / eta);
}

}  // namespace carousel::shading
