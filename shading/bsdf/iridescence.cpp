#include "shading/bsdf/iridescence.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

#include "core/numeric/exponential.h"
#include "shading/bsdf/fresnel.h"
#include "shading/bsdf/ggx.h"
#include "shading/math/trigonometry.h"

namespace carousel::shading {

namespace {

/// The response of the eye's three sensitivities, Gaussians in the Fourier domain, to a path difference; `shift` is the
/// phase of each RGB channel in turns, which the fit takes for X, Y and Z alike.
Vec3 sensitivity(float path_nm, const Vec3& shift) {
  struct Gaussian {
    float height, position, variance;
  };
  constexpr Gaussian kFits[4]{{5.4856e-13f, 1.6810e+06f, 4.3278e+09f},
                              {4.4201e-13f, 1.7953e+06f, 9.3046e+09f},
                              {5.2481e-13f, 2.2084e+06f, 6.6121e+09f},
                              {9.7470e-14f, 2.2399e+06f, 4.5282e+09f}};  // X has a second Gaussian
  const float path = path_nm * 1e-9f;
  const float phase = 2.0f * kPi * path;
  const auto term = [&](const Gaussian& g, float turns) {
    return g.height * std::sqrt(2.0f * kPi * g.variance) * sin_cos_turns(g.position * path + turns).cos *
           exp_float(-phase * phase * g.variance);
  };
  const Vec3 xyz =
      Vec3{term(kFits[0], shift.x) + term(kFits[3], shift.x), term(kFits[1], shift.y), term(kFits[2], shift.z)} *
      (1.0f / 1.0685e-7f);
  return {3.2404542f * xyz.x - 1.5371385f * xyz.y - 0.4985314f * xyz.z,
          -0.9692660f * xyz.x + 1.8760108f * xyz.y + 0.0415560f * xyz.z,
          0.0556434f * xyz.x - 0.2040259f * xyz.y + 1.0572252f * xyz.z};
}

}  // namespace

Vec3 film_reflectance(float cos_theta, float film_ior, float thickness_nm, const Vec3& base_f0) {
  // As the film's thickness goes to 0, its boundary must vanish as well.
  const float fade = std::clamp(thickness_nm / 0.03f, 0.0f, 1.0f);
  const float ior = 1.0f + (film_ior - 1.0f) * (fade * fade * (3.0f - 2.0f * fade));
  const float sine2 = (1.0f - cos_theta * cos_theta) / (ior * ior);
  if (!(sine2 < 1.0f)) return Vec3{1};
  const float cos_film = std::sqrt(1.0f - sine2);

  const float r12 = refraction(cos_theta, ior).reflected;  // Schlick's would not vanish with the film
  const float t121 = 1.0f - r12;
  const float phase21 = ior < 1.0f ? 0.0f : 0.5f;  // turns
  Vec3 r23, phase;
  for (int c = 0; c < 3; ++c) {
    const float root = std::sqrt(std::clamp(base_f0[c], 0.0f, 0.9999f));
    const float base_ior = (1.0f + root) / (1.0f - root);
    const float f0 = f0_of_eta(base_ior / ior);
    r23[c] = f0 + (1.0f - f0) * schlick_weight(cos_film);
    phase[c] = phase21 + (base_ior < ior ? 0.5f : 0.0f);
  }
  const float path = 2.0f * ior * thickness_nm * cos_film;
  const Vec3 r123 = glm::clamp(r12 * r23, 1e-5f, 0.9999f);
  const Vec3 root{std::sqrt(r123.x), std::sqrt(r123.y), std::sqrt(r123.z)};
  const Vec3 again = t121 * t121 * r23 / (Vec3{1} - r123);
  Vec3 sum = Vec3{r12} + again, order = again - Vec3{t121};
  for (int m = 1; m <= 2; ++m) {
    order *= root;
    sum += order * 2.0f * sensitivity(float(m) * path, float(m) * phase);
  }
  return glm::clamp(sum, 0.0f, 1.0f);
}

Vec3 f0_of_reflectance(const Vec3& reflectance, float cos_theta) {
  const float w = std::min(schlick_weight(cos_theta), 0.999f);
  return glm::clamp((reflectance - Vec3{w}) * (1.0f / (1.0f - w)), 0.0f, 1.0f);
}

}  // namespace carousel::shading
