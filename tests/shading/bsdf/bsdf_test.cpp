#include "shading/bsdf/bsdf.h"

#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "core/numeric/rng.h"
#include "shading/bsdf/lambert.h"
#include "shading/math/sampler.h"
#include "tests/shading/bsdf/bsdf_integrals.h"

namespace carousel::shading {
namespace {

constexpr float kMetalRoughnesses[] = {0.0f, 0.1f, 0.25f, 0.5f, 0.75f, 1.0f};

TEST(Bsdf, AWhiteSurfaceReflectsEverything) {
  for (const float metallic : {0.0f, 0.4f, 1.0f}) {
    for (const float roughness : kMetalRoughnesses) {
      for (const float cosine : kCosines) {
        const Bsdf bsdf({Vec3{1}, metallic, roughness}, direction(cosine));
        EXPECT_NEAR(white_albedo(bsdf).x, 1.0f, 0.02f) << metallic << " " << roughness << " " << cosine;
      }
    }
  }
}

TEST(Bsdf, NoSurfaceReflectsMoreThanArrives) {
  for (const Vec3& color : {Vec3{0, 0, 0}, Vec3{0.2f, 0.5f, 0.9f}}) {
    for (const float metallic : {0.0f, 1.0f}) {
      for (const float roughness : kMetalRoughnesses) {
        for (const float cosine : kCosines) {
          const Vec3 a = white_albedo(Bsdf({color, metallic, roughness}, direction(cosine)));
          for (int c = 0; c < 3; ++c) {
            EXPECT_GE(a[c], 0.0f);
            EXPECT_LE(a[c], 1.01f) << metallic << " " << roughness << " " << cosine;
          }
        }
      }
    }
  }
}

TEST(Bsdf, IsReciprocal) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0.02f, 1.0f);
  for (int i = 0; i < 2000; ++i) {
    const MaterialPoint material{{uniform(random), uniform(random), uniform(random)}, uniform(random), uniform(random)};
    const Vec3 a = direction(uniform(random), uniform(random)), b = direction(uniform(random), uniform(random));
    const Vec3 ab = Bsdf(material, a).evaluate(b).f_cos / b.z, ba = Bsdf(material, b).evaluate(a).f_cos / a.z;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(ab[c], ba[c], 2e-3f * std::max(ab[c], 1.0f));
  }
}

TEST(Bsdf, SamplesWithTheDensityItReports) {
  // Uniform directions, weighted by the density: its integral over the hemisphere is the share of samples
  // that end up above the horizon.
  for (const float roughness : {0.4f, 0.7f, 1.0f}) {
    for (const float cosine : kCosines) {
      const Bsdf bsdf({{0.5f, 0.5f, 0.5f}, 0.3f, roughness}, direction(cosine));
      constexpr std::uint32_t kSamples = 40000;
      const Sampler sampler(2, kSamples);
      double integral = 0, above = 0;
      for (std::uint32_t s = 0; s < kSamples; ++s) {
        const DirectionDraw draw = sampler.direction(0, s, 0);
        const float z = draw.direction.x;
        integral += 2 * kPi * bsdf.evaluate(direction(std::max(z, 1e-6f), draw.direction.y)).pdf / kSamples;
        above += bsdf.sample(draw.lobe, draw.direction).z > 0 ? 1.0 / kSamples : 0.0;
      }
      EXPECT_NEAR(integral, above, 0.02) << roughness << " " << cosine;
    }
  }
}

TEST(Bsdf, AMirrorReflectsAboutTheNormal) {
  const Vec3 wo = direction(0.6f, 0.2f);
  const Bsdf bsdf({Vec3{1}, 1, 0}, wo);
  const Vec3 wi = bsdf.sample(0.0f, {0.3f, 0.4f});
  EXPECT_NEAR(wi.x, -wo.x, 0.01f);
  EXPECT_NEAR(wi.y, -wo.y, 0.01f);
  EXPECT_NEAR(wi.z, wo.z, 0.01f);
}

TEST(Bsdf, RoughnessIsWidenedOnlyWhereItIsNarrow) {
  EXPECT_NEAR(widened_roughness(0.0f), 0.5477f, 1e-4f);
  EXPECT_NEAR(widened_roughness(0.5f), 0.5477f, 1e-4f);
  EXPECT_EQ(widened_roughness(0.6f), 0.6f);
  EXPECT_EQ(widened_roughness(1.0f), 1.0f);
}

}  // namespace
}  // namespace carousel::shading
