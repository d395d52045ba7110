#include "shading/bsdf/layered_bsdf.h"

#include <cmath>

#include <gtest/gtest.h>

#include "shading/bsdf/charlie.h"
#include "shading/bsdf/charlie_albedo.h"
#include "shading/bsdf/fresnel.h"
#include "shading/bsdf/interface_bsdf.h"
#include "shading/bsdf/iridescence.h"
#include "tests/shading/bsdf/bsdf_integrals.h"

namespace carousel::shading {
namespace {

LayerPoint layers(float coat, float coat_roughness, float sheen, float sheen_roughness) {
  return {coat, coat_roughness, {0, 0, 1}, Vec3{sheen}, sheen_roughness};
}

template <class Base>
void expect_white(const LayerPoint& l, const Base& base, const Vec3& wo) {
  const float a = white_albedo(LayeredBsdf<Base>(l, base, wo), 1 << 13).x;
  EXPECT_NEAR(a, 1.0f, 0.01f) << a << " coat " << l.coat << " " << l.coat_roughness << " sheen " << l.sheen.x << " "
                              << l.sheen_roughness << " cosine " << wo.z;
}

TEST(LayeredBsdf, AWhiteSurfaceReflectsEverythingUnderAnyLayers) {
  for (const float coat : {0.0f, 0.5f, 1.0f}) {
    for (const float coat_roughness : {0.0f, 0.7f}) {
      for (const float sheen : {0.0f, 0.6f, 1.0f}) {
        if (coat == 0 && coat_roughness > 0) continue;
        for (const float sheen_roughness : {0.25f, 0.5f, 1.0f}) {
          if (sheen == 0 && sheen_roughness > 0.25f) continue;
          const LayerPoint l = layers(coat, coat_roughness, sheen, sheen_roughness);
          for (const float cosine : {0.15f, 0.7f}) {
            const Vec3 wo = direction(cosine, 0.1f);
            for (const float roughness : {0.0f, 0.6f}) {
              expect_white(l, Bsdf({Vec3{1}, roughness == 0 ? 1.0f : 0.0f, roughness}, wo), wo);
              InterfacePoint p;
              p.material = {Vec3{1}, 0, roughness};
              p.alpha = Vec2{ggx_alpha(roughness)};
              p.transmission = 0.8f;
              p.eta = 1.5f;
              p.glass = &GlassAlbedo::of(1.5f);
              expect_white(l, InterfaceBsdf<true>(p, wo), wo);
            }
          }
        }
      }
    }
  }
}

TEST(LayeredBsdf, WithoutLayersItIsTheBaseToTheBit) {
  for (const float cosine : kCosines) {
    const Vec3 wo = direction(cosine, 0.3f);
    const Bsdf base({{0.3f, 0.6f, 0.9f}, 0.4f, 0.3f}, wo);
    const LayeredBsdf<Bsdf> layered(layers(0, 0, 0, 0), base, wo);
    const Sampler sampler(3, 1000);
    for (std::uint32_t s = 0; s < 1000; ++s) {
      const DirectionDraw draw = sampler.direction(0, s, 0);
      const Vec3 wi = base.sample(draw.lobe, draw.direction);
      EXPECT_EQ(layered.sample(draw.lobe, draw.direction), wi);
      EXPECT_EQ(layered.is_wide(draw.lobe), base.is_wide(draw.lobe));
      EXPECT_EQ(layered.evaluate(wi).f_cos, base.evaluate(wi).f_cos);
      EXPECT_EQ(layered.evaluate(wi).pdf, base.evaluate(wi).pdf);
    }
  }
}

TEST(LayeredBsdf, SamplesWithTheDensityItReports) {
  for (const float cosine : kCosines) {
    const Vec3 wo = direction(cosine, 0.2f);
    LayerPoint l = layers(0.8f, 0.6f, 0.7f, 0.5f);
    l.coat_normal = glm::normalize(Vec3{0.1f, -0.05f, 1});
    if (cosine < 0.2f) l.coat_normal = {0, 0, 1};
    const LayeredBsdf<Bsdf> bsdf(l, Bsdf({Vec3{0.5f}, 0.3f, 0.7f}, wo), wo);
    const Moments above = moments(bsdf, 1);
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(above.density[k], above.samples[k], 0.02) << cosine << " " << k;
  }
}

TEST(LayeredBsdf, ACoatReflectsItsFourPercent) {
  const Vec3 wo{0, 0, 1};
  const LayeredBsdf<Bsdf> bsdf(layers(1, 0, 0, 0), Bsdf({Vec3{0}, 1, 1}, wo), wo);
  EXPECT_NEAR(white_albedo(bsdf).x, 0.04f, 0.002f);
}

TEST(Charlie, IsReciprocalAndReflectsNoMoreThanArrives) {
  for (const float roughness : {0.25f, 0.3f, 0.6f, 1.0f}) {
    const float alpha = charlie_alpha(roughness);
    for (const float a : kCosines) {
      EXPECT_LE(CharlieAlbedo::table().directional(a, alpha), 1.0f);
      EXPECT_GT(CharlieAlbedo::table().directional(a, alpha), 0.0f);
      for (const float b : kCosines) {
        const Vec3 x = direction(a, 0.1f), y = direction(b, 0.4f);
        const float xy = charlie_f_cos(x, y, alpha) / y.z, yx = charlie_f_cos(y, x, alpha) / x.z;
        EXPECT_NEAR(xy, yx, 1e-4f * std::max(1.0f, xy));
      }
    }
  }
}

TEST(Iridescence, AFilmOfNoThicknessIsNotThere) {
  for (const float f0 : {0.04f, 0.3f, 0.8f}) {
    for (const float cosine : {0.2f, 0.6f, 1.0f}) {
      const Vec3 r = film_reflectance(cosine, 1.3f, 0, Vec3{f0});
      const float expected = f0 + (1 - f0) * schlick_weight(cosine);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(r[c], expected, 0.02f) << f0 << " " << cosine;
    }
  }
}

/// Airy's formula for one wavelength and normal incidence, averaged over a band around each channel's wavelength.
float airy(float n, float base, float nm, float wavelength) {
  const double r1 = (1.0 - n) / (1.0 + n), r2 = (n - base) / (n + base);
  const double phase = 4 * 3.14159265358979 * n * nm / wavelength;
  const double num = r1 * r1 + r2 * r2 + 2 * r1 * r2 * std::cos(phase),
               den = 1 + r1 * r1 * r2 * r2 + 2 * r1 * r2 * std::cos(phase);
  return float(num / den);
}

TEST(Iridescence, InterferenceFollowsAirysFormula) {
  // Green's sensitivity is narrow enough for the sum over its band to follow a single wavelength's curve roughly.
  const float base_f0 = 0.04f;
  for (const float nm : {80.0f, 120.0f, 200.0f, 260.0f}) {
    const float green = film_reflectance(1, 1.8f, nm, Vec3{base_f0}).y;
    float expected = 0;
    for (int k = -2; k <= 2; ++k) expected += airy(1.8f, 1.5f, nm, 545.0f + 20.0f * float(k)) / 5;
    EXPECT_NEAR(green, expected, 0.05f) << nm;
  }
}

}  // namespace
}  // namespace carousel::shading
