#pragma once

#include <cmath>
#include <cstdint>

#include "core/types/vec.h"
#include "shading/bsdf/bsdf.h"
#include "shading/bsdf/lambert.h"
#include "shading/math/sampler.h"
#include "shading/math/trigonometry.h"

namespace carousel::shading {

/// Cosines of wo, from grazing to along the normal.
inline constexpr float kCosines[] = {0.05f, 0.3f, 0.7f, 1.0f};

inline Vec3 direction(float cosine, float turns = 0) {
  const SinCos angle = sin_cos_turns(turns);
  const float sine = std::sqrt(1 - cosine * cosine);
  return {sine * angle.cos, sine * angle.sin, cosine};
}

/// Share of the light of a white world that the surface sends towards wo, by its own importance sampling.
template <class SomeBsdf>
Vec3 white_albedo(const SomeBsdf& bsdf, std::uint32_t samples = 1 << 14) {
  const Sampler sampler(1, samples);
  DVec3 sum{0};
  for (std::uint32_t s = 0; s < samples; ++s) {
    const DirectionDraw draw = sampler.direction(0, s, 0);
    const BsdfValue value = bsdf.evaluate(bsdf.sample(draw.lobe, draw.direction));
    if (value.pdf > 0) sum += DVec3(value.f_cos / value.pdf);
  }
  return Vec3(sum / double(samples));
}

/// Means of 1, |x|, |y| and |z| over one hemisphere's directions (`side` 1 above, -1 below): by the reported density,
/// and by the drawn samples.
struct Moments {
  glm::dvec4 density{0}, samples{0};
};
template <class SomeBsdf>
Moments moments(const SomeBsdf& bsdf, float side, std::uint32_t count = 30000) {
  const auto of = [](const Vec3& w) { return glm::dvec4(1, std::abs(w.x), std::abs(w.y), std::abs(w.z)); };
  const Sampler sampler(2, count);
  Moments m;
  for (std::uint32_t s = 0; s < count; ++s) {
    const DirectionDraw draw = sampler.direction(0, s, 0);
    Vec3 even = direction(std::max(draw.direction.x, 1e-6f), draw.direction.y);
    even.z *= side;
    m.density += of(even) * double(2 * kPi * bsdf.evaluate(even).pdf / float(count));
    const Vec3 wi = bsdf.sample(draw.lobe, draw.direction);
    if (wi.z * side > 0) m.samples += of(wi) / double(count);
  }
  return m;
}

}  // namespace carousel::shading
