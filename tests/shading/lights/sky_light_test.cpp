#include "shading/lights/sky_light.h"

#include <cmath>
#include <functional>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "core/numeric/trigonometry.h"
#include "shading/lights/light_set.h"
#include "shading/lights/sky_facts.h"
#include "shading/math/sampler.h"
#include "shading/math/spherical.h"
#include "tests/shading/path/small_scenes.h"

namespace carousel::shading {
namespace {

constexpr double kPiDouble = 3.14159265358979323846;

scene::SkyMap map_of(std::uint32_t width, std::uint32_t height,
                     const std::function<Vec3(std::uint32_t, std::uint32_t)>& color, float rotation = 0) {
  scene::SkyMap map{"test", width, height, {}, rotation};
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) map.texels.push_back(color(x, y));
  return map;
}

/// Dark, with a sun of one texel, and a black row.
scene::SkyMap sunny(std::uint32_t width, std::uint32_t height) {
  return map_of(width, height, [&](std::uint32_t x, std::uint32_t y) {
    if (y == height / 2) return Vec3{0};
    return x == width / 4 && y == height / 4 ? Vec3{900, 800, 500} : Vec3{0.1f + 0.02f * float(x), 0.2f, 0.3f};
  });
}

/// Directions on a grid of longitude and latitude with their parts of the sphere.
void over_sphere(int rows, const std::function<void(const Vec3&, double)>& visit) {
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < 2 * rows; ++c) {
      const double polar = kPiDouble * (r + 0.5) / rows, around = kPiDouble * (c + 0.5) / rows;
      const double part = kPiDouble / rows * (std::cos(kPiDouble * r / rows) - std::cos(kPiDouble * (r + 1) / rows));
      visit(Vec3(DVec3(std::sin(polar) * std::sin(around), std::cos(polar), -std::sin(polar) * std::cos(around))),
            part);
    }
}

TEST(SphericalMath, AgreesWithTheLibrary) {
  for (int i = 0; i <= 1000; ++i) EXPECT_NEAR(cos_half_turns(i / 1000.0), std::cos(kPiDouble * i / 1000), 1e-14) << i;
  EXPECT_EQ(cos_half_turns(0), 1.0);
  EXPECT_EQ(cos_half_turns(0.5), 0.0);
  EXPECT_EQ(cos_half_turns(1), -1.0);
  for (int i = -1000; i <= 1000; ++i) {
    const double angle = kPiDouble * i / 1000, radius = std::exp2(i % 60);
    EXPECT_NEAR(angle_in_turns(radius * std::sin(angle), radius * std::cos(angle)), i / 2000.0, i == -1000 ? 1 : 1e-13)
        << i;
  }
  EXPECT_EQ(angle_in_turns(0, 0), 0.0);
  EXPECT_EQ(angle_in_turns(1, 0), 0.25);
  EXPECT_EQ(angle_in_turns(0, -1), 0.5);
}

TEST(SkyLight, TheMiddleIsSeenAlongMinusZAndTurnsWithTheRotation) {
  // Columns from the left: behind and to the left, ahead on the left, ahead on the right, behind on the right.
  const auto color = [](std::uint32_t x, std::uint32_t) { return Vec3{float(x + 1)}; };
  const auto seen = [&](const Vec3& direction, float rotation) {
    const scene::SkyMap map = map_of(4, 1, color, rotation);
    return SkyLight(map).radiance(direction).x;
  };
  const Vec3 ahead_right = glm::normalize(Vec3{1, 0, -1}), ahead_left = glm::normalize(Vec3{-1, 0, -1});
  EXPECT_NEAR(seen(ahead_left, 0), 2, 1e-6f);
  EXPECT_NEAR(seen(ahead_right, 0), 3, 1e-6f);
  EXPECT_NEAR(seen({0, 0, -1}, 0), 2.5f, 1e-6f) << "between two centres";
  EXPECT_NEAR(seen({0, 0, 5}, 0), 2.5f, 1e-6f) << "over the seam, and of any length";
  EXPECT_NEAR(seen({1, 0, 0}, 0), 3.5f, 1e-6f);
  EXPECT_NEAR(seen(ahead_left, 0.25f), 3, 1e-6f) << "a quarter turn moves what was right to the left";
  EXPECT_NEAR(seen(ahead_right, 0.75f), 2, 1e-6f);
  const scene::SkyMap upright = map_of(1, 2, [](std::uint32_t, std::uint32_t y) { return Vec3{y == 0 ? 1.0f : 2.0f}; });
  EXPECT_EQ(SkyLight(upright).radiance({0, 1, 0}).x, 1);
  EXPECT_EQ(SkyLight(upright).radiance({0, -1, 0}).x, 2);
}

TEST(SkyLight, DensityIntegratesToOneAndFollowsTheLight) {
  for (const scene::SkyMap& map : {sunny(16, 8), sunny(31, 17), map_of(1, 1, [](auto, auto) { return Vec3{2}; }),
                                   map_of(2, 1, [](auto x, auto) { return Vec3{float(x)}; })}) {
    const SkyLight light(map);
    double density = 0, luminance = 0;
    // The grid's cells lie within texels: 31 times 68 and 17 times 62 of them.
    over_sphere(62 * static_cast<int>(map.height), [&](const Vec3& direction, double part) {
      const SkyLight::Seen seen = light.look(direction);
      density += part * double{seen.pdf};
      luminance += part * (0.2126 * double{seen.radiance.x} + 0.7152 * double{seen.radiance.y} +
                           0.0722 * double{seen.radiance.z});
      EXPECT_TRUE(seen.pdf > 0.0f || seen.radiance.x < 1e-4f) << "light is never drawn from a place that has some";
    });
    EXPECT_NEAR(density, 1, 1e-5) << map.width;
    EXPECT_NEAR(light.irradiance(), luminance, 0.02 * luminance) << map.width;
  }
}

// Averages of radiance over density times a function of the direction, against quadrature.
TEST(SkyLight, SamplesGiveTheIntegralsOfTheirDensity) {
  for (const float rotation : {0.0f, 0.3f}) {
    scene::SkyMap map = sunny(31, 17);
    map.rotation = rotation;
    const SkyLight light(map);
    for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{-0.6f, 0, -0.8f}}) {
      double expected = 0, sampled = 0;
      over_sphere(340, [&](const Vec3& w, double part) {
        expected += part * double{light.radiance(w).x} * std::max(0.0, double{glm::dot(w, axis)});
      });
      constexpr std::uint32_t kSamples = 1 << 16;
      const Sampler sampler(3, kSamples);
      for (std::uint32_t s = 0; s < kSamples; ++s) {
        const SkyLight::Sample one = light.sample(sampler.light(0, s, 0).point);
        ASSERT_NEAR(glm::length(one.direction), 1, 1e-5f);
        sampled += double{light.radiance(one.direction).x / one.pdf} *
                   std::max(0.0, double{glm::dot(one.direction, axis)}) / kSamples;
      }
      EXPECT_NEAR(sampled, expected, 0.01 * expected + 1e-3) << axis.x << " " << axis.y << " " << axis.z;
    }
  }
}

TEST(SkyLight, ASampleHasTheDensityThatIsSeenThere) {
  const scene::SkyMap map = sunny(64, 32);
  const SkyLight light(map);
  const Sampler sampler(5, 4096);
  int others = 0;  // at borders of texels
  for (std::uint32_t s = 0; s < 4096; ++s) {
    const SkyLight::Sample one = light.sample(sampler.light(1, s, 0).point);
    others += one.pdf == light.look(one.direction).pdf ? 0 : 1;
  }
  EXPECT_LE(others, 4);
}

TEST(SkyLight, NoLightIsNoLight) {
  EXPECT_TRUE(SkyLight(scene::SkyMap{}).empty());
  const scene::SkyMap black = map_of(8, 4, [](auto, auto) { return Vec3{0}; });
  EXPECT_TRUE(SkyLight(black).empty());
  scene::Scene scene = empty_scene();
  scene.sky.map = black;
  EXPECT_TRUE(LightSet(scene).empty());
  // One texel that is lit, the last or the first.
  for (const std::uint32_t lit : {0u, 31u}) {
    const scene::SkyMap map = map_of(8, 4, [&](auto x, auto y) { return Vec3{8 * y + x == lit ? 1.0f : 0.0f}; });
    const SkyLight light(map);
    for (const Vec2& u : {Vec2{0, 0}, Vec2{0x1.fffffep-1f, 0x1.fffffep-1f}, Vec2{0.3f, 0.7f}}) {
      EXPECT_GT(light.sample(u).pdf, 0.0f);
    }
  }
}

TEST(SkyLight, ReadsTheTexelsAroundADirectionAndTheBlocksOfItsSearch) {
  const scene::SkyMap map = sunny(64, 32);
  const SkyLight light(map);
  std::vector<SkyRead> reads;
  light.append_reads(Vec3{0, 0, -1}, reads);  // between columns 31 and 32, rows 15 and 16
  const std::uint64_t tables = 64 * 32 * 16;
  EXPECT_EQ(reads, (std::vector<SkyRead>{{(15 * 64 + 31) * 16, 32},
                                         {(16 * 64 + 31) * 16, 32},
                                         {tables + 64, 64},
                                         {tables + 4 * 32 + (16 * 64 + 32) * 4, 64}}));
  reads.clear();
  light.append_reads(Vec3{1e-9f, 0, 1}, reads);  // over the seam
  EXPECT_EQ(reads[0], (SkyRead{(15 * 64 + 63) * 16, 16}));
  EXPECT_EQ(reads[1], (SkyRead{15 * 64 * 16, 16}));
  reads.clear();
  light.append_reads(Vec3{0, 1, 0}, reads);
  EXPECT_EQ(reads.size(), 3u) << "at the pole there is no row above";
  reads.clear();
  light.append_reads(Vec2{0.4f, 0.6f}, reads);
  ASSERT_GE(reads.size(), 4u);
  for (const SkyRead& read : reads) EXPECT_LE(read.offset + read.bytes, tables + 4 * 32 + 4 * 64 * 32 + 63);
  EXPECT_EQ(reads.back().bytes, 32u);
}

TEST(SkyFacts, AreMeanAndShareOfTheBrightest) {
  const SkyFacts even = sky_facts(map_of(16, 8, [](auto, auto) { return Vec3{1, 2, 3}; }));
  EXPECT_NEAR(even.mean.z, 3, 1e-5f);
  EXPECT_NEAR(even.brightest_percent, 0.01, 1e-9);
  // A texel on the equator has 1/2 (cos(3 pi / 8) - cos(pi / 2)) / 16 of the sphere, which is more than a hundredth.
  const SkyFacts one = sky_facts(map_of(16, 8, [](auto x, auto y) { return Vec3{x == 3 && y == 3 ? 5.0f : 0.0f}; }));
  const double share = std::cos(3 * kPiDouble / 8) / 32;
  EXPECT_NEAR(one.mean.x, 5 * share, 1e-6f);
  EXPECT_NEAR(one.brightest_percent, 0.01 / share, 1e-6);
  EXPECT_NEAR(one.most, 5, 1e-5f);
}

}  // namespace
}  // namespace carousel::shading
