#include "shading/surface/texture_lookup.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "shading/math/srgb.h"

namespace carousel::shading {
namespace {

/// 2 x 2: black, red / green, blue.
scene::Scene four_texels(scene::Wrap wrap, bool linear) {
  scene::Scene scene;
  scene.images.push_back({"four", 2, 2, {0, 0, 0, 255, 255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255}});
  scene.textures.push_back({ImageId(0), wrap, wrap, linear});
  return scene;
}

Vec3 at(const scene::Scene& scene, float u, float v) {
  return lookup(scene, TextureId(0), {u, v}, Encoding::kLinear);
}

TEST(TextureLookup, StartsAtTheTopLeft) {
  for (const bool linear : {false, true}) {
    const scene::Scene scene = four_texels(scene::Wrap::kRepeat, linear);
    EXPECT_EQ(at(scene, 0.25f, 0.25f), Vec3(0, 0, 0));
    EXPECT_EQ(at(scene, 0.75f, 0.25f), Vec3(1, 0, 0));
    EXPECT_EQ(at(scene, 0.25f, 0.75f), Vec3(0, 1, 0));
    EXPECT_EQ(at(scene, 0.75f, 0.75f), Vec3(0, 0, 1));
  }
}

TEST(TextureLookup, BlendsBetweenTexelCentres) {
  const scene::Scene scene = four_texels(scene::Wrap::kClamp, true);
  EXPECT_EQ(at(scene, 0.5f, 0.25f), Vec3(0.5f, 0, 0));
  EXPECT_EQ(at(scene, 0.5f, 0.5f), Vec3(0.25f, 0.25f, 0.25f));
}

TEST(TextureLookup, WrapsAsTheSamplerSays) {
  EXPECT_EQ(at(four_texels(scene::Wrap::kRepeat, false), 1.25f, -0.25f), Vec3(0, 1, 0));
  EXPECT_EQ(at(four_texels(scene::Wrap::kClamp, false), 1.25f, -0.25f), Vec3(1, 0, 0));
  EXPECT_EQ(at(four_texels(scene::Wrap::kMirror, false), 1.25f, 0.25f), Vec3(1, 0, 0));
  EXPECT_EQ(at(four_texels(scene::Wrap::kMirror, false), -0.25f, 0.25f), Vec3(0, 0, 0));
  EXPECT_EQ(at(four_texels(scene::Wrap::kRepeat, true), 0.0f, 0.25f), Vec3(0.5f, 0, 0));  // across the seam
  EXPECT_EQ(at(four_texels(scene::Wrap::kClamp, true), 0.0f, 0.25f), Vec3(0, 0, 0));
}

TEST(TextureLookup, SurvivesUglyCoordinates) {
  const scene::Scene scene = four_texels(scene::Wrap::kRepeat, true);
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const float u : {kInf, -kInf, std::numeric_limits<float>::quiet_NaN(), 1e30f, -1e30f}) {
    EXPECT_EQ(at(scene, u, 0.25f), Vec3(0, 0, 0));
    EXPECT_EQ(at(scene, 0.25f, u), Vec3(0, 0, 0));
  }
  scene::Scene empty = four_texels(scene::Wrap::kRepeat, true);
  empty.images[0] = {};
  EXPECT_EQ(at(empty, 0.5f, 0.5f), Vec3(1, 1, 1));
}

TEST(TextureLookup, DecodesSrgbBeforeBlending) {
  scene::Scene scene;
  scene.images.push_back({"grey", 2, 1, {0, 0, 0, 255, 255, 255, 255, 255}});
  scene.textures.push_back({ImageId(0), scene::Wrap::kClamp, scene::Wrap::kClamp, true});
  EXPECT_EQ(lookup(scene, TextureId(0), {0.5f, 0.5f}, Encoding::kSrgb), Vec3(0.5f, 0.5f, 0.5f));
}

TEST(TransformUv, ScalesThenRotatesThenMoves) {
  scene::TextureUse use;
  use.offset = {10, 20};
  use.scale = {2, 3};
  EXPECT_EQ(transform_uv(use, {1, 1}), Vec2(12, 23));
  use.rotation = 1.57079633f;
  const Vec2 turned = transform_uv(use, {1, 0});  // (2, 0) turned by 90 degrees
  EXPECT_NEAR(turned.x, 10, 1e-5f);
  EXPECT_NEAR(turned.y, 18, 1e-5f);
}

TEST(Srgb, TableMatchesTheStandardAndIsFarFromTies) {
  const auto& table = srgb_to_linear();
  EXPECT_EQ(table[0], 0.0f);
  EXPECT_EQ(table[255], 1.0f);
  for (int i = 1; i < 255; ++i) {
    const long double c = i / 255.0L;
    const long double exact = c <= 0.04045L ? c / 12.92L : std::pow((c + 0.055L) / 1.055L, 2.4L);
    const float value = table[std::size_t(i)];
    const float up = std::nextafter(value, 2.0f), down = std::nextafter(value, -1.0f);
    const long double above = 0.5L * (static_cast<long double>(value) + up);
    const long double below = 0.5L * (static_cast<long double>(value) + down);
    // An error of a few double ulps cannot lead to another float.
    EXPECT_GT(above - exact, 1e-15L * exact) << i;
    EXPECT_GT(exact - below, 1e-15L * exact) << i;
    EXPECT_NEAR(linear_to_srgb(value) * 255.0f, float(i), 1e-2f);
  }
}

}  // namespace
}  // namespace carousel::shading
