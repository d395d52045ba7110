#include "shading/bsdf/interface_bsdf.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "shading/bsdf/fresnel.h"
#include "shading/bsdf/ggx.h"
#include "shading/bsdf/refraction_lobe.h"
#include "tests/shading/bsdf/bsdf_integrals.h"
#include "tests/support/random_runs.h"

namespace carousel::shading {
namespace {

constexpr float kRoughnesses[] = {0.0f, 0.25f, 0.5f, 1.0f};

InterfacePoint white(float metallic, float roughness, float transmission = 0) {
  InterfacePoint p;
  p.material = {Vec3{1}, metallic, roughness};
  p.alpha = Vec2{ggx_alpha(roughness)};
  p.transmission = transmission;
  return p;
}

InterfacePoint glass(float eta, float roughness, float transmission = 1) {
  InterfacePoint p = white(0, roughness, transmission);
  p.eta = eta;
  p.glass = &GlassAlbedo::of(eta);
  p.dielectric_f0 = Vec3{f0_of_eta(eta)};
  return p;
}

/// Over roughness and direction.
template <bool kTransmits>
void expect_white(InterfacePoint p) {
  for (const float roughness : kRoughnesses) {
    for (const float cosine : kCosines) {
      const float stretch = p.alpha.x / p.alpha.y;
      p.material.roughness = roughness;
      p.alpha = Vec2{ggx_alpha(roughness)};
      p.alpha.x = std::min(p.alpha.y * stretch, 1.0f);
      const Vec3 a = white_albedo(InterfaceBsdf<kTransmits>(p, direction(cosine, 0.1f)));
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(a[c], 1, 0.01) << a[c] << " roughness " << roughness << " cosine " << cosine << " channel " << c;
      }
    }
  }
}

TEST(InterfaceBsdf, AWhiteSurfaceReflectsEverythingWhateverItsFresnelFactor) {
  for (const float metallic : {0.0f, 0.6f}) {
    for (const Vec3& f0 : {Vec3{0.04f}, Vec3{0.0f}, Vec3{0.2f, 0.04f, 0.5f}, Vec3{1.0f}}) {
      for (const float f90 : {1.0f, 0.3f}) {
        InterfacePoint p = white(metallic, 0);
        p.dielectric_f0 = f0;
        p.dielectric_f90 = std::max(f90, std::max({f0.x, f0.y, f0.z}));
        SCOPED_TRACE(testing::Message() << metallic << " f0 " << f0.x << " " << f0.y << " f90 " << f90);
        expect_white<false>(p);
      }
    }
  }
}

TEST(InterfaceBsdf, StretchedHighlightsLoseNothing) {
  for (const float stretch : {2.0f, 5.0f, 20.0f}) {
    for (const float metallic : {0.0f, 1.0f}) {
      InterfacePoint p = white(metallic, 0);
      p.alpha = {stretch, 1};
      SCOPED_TRACE(testing::Message() << "stretched " << stretch << " times, metallic " << metallic);
      expect_white<false>(p);
    }
  }
}

TEST(InterfaceBsdf, AThinWallReflectsOrTransmitsEverything) {
  for (const float metallic : {0.0f, 0.3f}) {
    for (const float transmission : {0.3f, 1.0f}) {
      InterfacePoint p = white(metallic, 0, transmission);
      p.dielectric_f0 = {0.04f, 0.2f, 0.01f};
      SCOPED_TRACE(testing::Message() << metallic << " " << transmission);
      expect_white<true>(p);
    }
  }
}

TEST(InterfaceBsdf, GlassReflectsOrRefractsEverythingFromEitherSide) {
  for (const float eta : {1.1f, 1.5f, 2.4f, 1 / 1.1f, 1 / 1.5f, 1 / 2.4f}) {
    for (const float transmission : {0.4f, 1.0f}) {
      SCOPED_TRACE(testing::Message() << "eta " << eta << " transmission " << transmission);
      expect_white<true>(glass(eta, 0, transmission));
    }
  }
}

TEST(InterfaceBsdf, SpecularWeightAndColourChangeGlassButLoseNothing) {
  InterfacePoint p = glass(1.5f, 0);
  p.dielectric_f0 *= Vec3{0.5f, 0.2f, 1.0f};
  p.dielectric_f90 = 0.5f;
  expect_white<true>(p);
  p = glass(1 / 1.5f, 0);
  p.dielectric_f0 *= 0.5f;
  p.dielectric_f90 = 0.5f;
  expect_white<true>(p);
}

TEST(InterfaceBsdf, OpaqueSurfacesAndThinWallsAreReciprocal) {
  std::mt19937 random(run_seed() * 7 + 1);
  std::uniform_real_distribution<float> uniform(0.05f, 1.0f);
  for (int i = 0; i < 2000; ++i) {
    InterfacePoint p = white(uniform(random), uniform(random), i % 2 ? uniform(random) : 0);
    p.material.base_color = {uniform(random), uniform(random), uniform(random)};
    p.metal_f0 = p.material.base_color;
    p.dielectric_f0 = {0.3f * uniform(random), 0.1f, 0.2f};
    p.alpha = Vec2{uniform(random)};
    const Vec3 a = direction(uniform(random), uniform(random)), b = direction(uniform(random), uniform(random));
    const Vec3 below{b.x, b.y, -b.z}, a_below{a.x, a.y, -a.z};
    const Vec3 ab = InterfaceBsdf<true>(p, a).evaluate(b).f_cos / b.z,
               ba = InterfaceBsdf<true>(p, b).evaluate(a).f_cos / a.z;
    const Vec3 through = InterfaceBsdf<true>(p, a).evaluate(below).f_cos / b.z,
               back = InterfaceBsdf<true>(p, b).evaluate(a_below).f_cos / a.z;
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(ab[c], ba[c], 2e-3f * std::max(ab[c], 1.0f)) << i;
      EXPECT_NEAR(through[c], back[c], 2e-3f * std::max(through[c], 1.0f)) << i;
    }
  }
}

TEST(InterfaceBsdf, RefractionIsReciprocalInRadianceOverIndexSquared) {
  std::mt19937 random(run_seed() * 7 + 2);
  std::uniform_real_distribution<float> uniform(0.05f, 1.0f);
  int met = 0;
  for (int i = 0; i < 2000; ++i) {
    const float eta = 1 + uniform(random);
    const Vec2 alpha{uniform(random), uniform(random)};
    const Vec3 a = direction(uniform(random), uniform(random));
    Vec3 b = direction(uniform(random), uniform(random));
    b.z = -b.z;
    const ThroughValue down = refracted_value(a, b, alpha, eta);
    const ThroughValue up = refracted_value({b.x, b.y, -b.z}, {a.x, a.y, -a.z}, alpha, 1 / eta);
    const float f_down = down.f_cos / -b.z / (eta * eta), f_up = up.f_cos / a.z;
    EXPECT_NEAR(f_down, f_up, 2e-3f * std::max(f_down, 1e-2f)) << i;
    met += f_down > 0 ? 1 : 0;
  }
  EXPECT_GT(met, 200);
}

TEST(InterfaceBsdf, SamplesWithTheDensityItReports) {
  for (const float eta : {1.0f, 1.5f, 1 / 1.5f}) {
    for (const float roughness : {0.5f, 0.7f, 1.0f}) {
      for (const float cosine : kCosines) {
        InterfacePoint p = eta == 1.0f ? white(0.2f, roughness, 0.7f) : glass(eta, roughness, 0.7f);
        p.alpha.x = std::min(1.0f, 1.5f * p.alpha.y);
        const InterfaceBsdf<true> bsdf(p, direction(cosine, 0.2f));
        const Moments above = moments(bsdf, 1), below = moments(bsdf, -1);
        for (int k = 0; k < 4; ++k) {
          EXPECT_NEAR(above.density[k], above.samples[k], 0.02) << eta << " " << roughness << " " << cosine << " " << k;
          EXPECT_NEAR(below.density[k], below.samples[k], 0.02) << eta << " " << roughness << " " << cosine << " " << k;
        }
      }
    }
  }
}

TEST(InterfaceBsdf, SmoothGlassBendsLightAsSnellSays) {
  for (const float eta : {1.33f, 1.5f, 2.0f, 1 / 1.33f}) {
    for (const float sine : {0.0f, 0.3f, 0.6f}) {
      const float cosine = std::sqrt(1 - sine * sine);
      const Vec3 wo{sine, 0, cosine};
      const InterfaceBsdf<true> bsdf(glass(eta, 0), wo);
      const Vec3 wi = bsdf.sample(0.98f, {0.37f, 0.4f});  // reflection has the small lobe numbers
      ASSERT_LT(wi.z, 0.0f);
      EXPECT_NEAR(wi.x, -sine / eta, 3e-3f);
      EXPECT_NEAR(wi.y, 0.0f, 3e-3f);
      EXPECT_NEAR(wi.z, -std::sqrt(1 - sine * sine / (eta * eta)), 3e-3f);
    }
  }
}

TEST(InterfaceBsdf, BeyondTheCriticalAngleEverythingIsReflected) {
  const double critical = std::asin(1 / 1.5);
  for (const double offset : {-0.02, 0.02, 0.1}) {
    const float cosine = float(std::cos(critical + offset));
    const InterfaceBsdf<true> bsdf(glass(1 / 1.5f, 0), direction(cosine));
    int through = 0;
    for (int i = 0; i < 100; ++i) through += bsdf.sample((float(i) + 0.5f) / 100, {0.3f, 0.1f}).z < 0 ? 1 : 0;
    if (offset > 0)
      EXPECT_EQ(through, 0) << offset;
    else
      EXPECT_GT(through, 30) << offset;
  }
}

TEST(Refraction, FollowsFresnelInClosedForm) {
  EXPECT_NEAR(refraction(1.0f, 1.5f).reflected, 0.04f, 1e-6f);
  EXPECT_NEAR(refraction(1.0f, 1 / 1.5f).reflected, 0.04f, 1e-6f);
  // At Brewster's angle light polarised in the plane is not reflected; the rest is ((n^2-1)/(n^2+1))^2.
  const float brewster = 1 / std::sqrt(1 + 1.5f * 1.5f);
  EXPECT_NEAR(refraction(brewster, 1.5f).reflected, 0.5f * std::pow((2.25f - 1) / (2.25f + 1), 2.0f), 1e-5f);
  EXPECT_TRUE(refraction(0.7f, 1 / 1.5f).total);    // sine 0.714 > 2/3
  EXPECT_FALSE(refraction(0.76f, 1 / 1.5f).total);  // sine 0.65 < 2/3
  EXPECT_EQ(refraction(0.7f, 1 / 1.5f).reflected, 1.0f);
}

TEST(InterfaceBsdf, AThinSmoothWallLetsLightGoStraightOn) {
  const Vec3 wo = direction(0.6f, 0.2f);
  const InterfaceBsdf<true> bsdf(white(0, 0, 1), wo);
  const Vec3 wi = bsdf.sample(0.98f, {0.3f, 0.2f});
  EXPECT_NEAR(wi.x, -wo.x, 3e-3f);
  EXPECT_NEAR(wi.y, -wo.y, 3e-3f);
  EXPECT_NEAR(wi.z, -wo.z, 3e-3f);
}

}  // namespace
}  // namespace carousel::shading
