#include "shading/surface/alpha_test.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/numeric/octahedral.h"
#include "scene/model/opacity.h"
#include "tests/shading/path/small_scenes.h"
#include "tests/support/random_runs.h"

namespace carousel::shading {
namespace {

/// A unit square over [0, 1]^2 with a texture whose left half is opaque and whose right half is not.
scene::Scene cut_square(scene::AlphaMode mode, float right_alpha) {
  scene::Scene scene = empty_scene();
  const auto right = static_cast<std::uint8_t>(right_alpha * 255 + 0.5f);
  scene.images.push_back({"halves", 2, 1, {10, 20, 30, 255, 40, 50, 60, right}});
  scene.textures.push_back({ImageId(0), scene::Wrap::kClamp, scene::Wrap::kClamp, false});
  scene::Material m = matte({1, 1, 1});
  m.alpha_mode = mode;
  m.base_color_texture.emplace();
  add_quad(scene, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, add_material(scene, m));
  scene.meshes[0].uv0 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  return scene;
}

/// A ray to (x, y) of the square, which triangle 0 covers for y < x.
bool accepts(const scene::Scene& scene, float x, float y, const Vec3& from = {0.5f, 0.5f, 3}) {
  Ray ray;
  ray.origin = from;
  ray.direction = Vec3{x, y, 0} - from;
  const bool lower = y < x;  // vertices 0 1 2, else 0 2 3
  return AlphaTest(scene).accepts(ray, 0, lower ? 0 : 1, lower ? x - y : x, lower ? y : y - x);
}

TEST(AlphaTest, ATextureCutsHoles) {
  const scene::Scene scene = cut_square(scene::AlphaMode::kMask, 0.25f);
  for (const float y : {0.1f, 0.45f, 0.9f}) {
    for (const float x : {0.05f, 0.3f, 0.49f}) EXPECT_TRUE(accepts(scene, x, y)) << x << " " << y;
    for (const float x : {0.51f, 0.6f, 0.95f}) EXPECT_FALSE(accepts(scene, x, y)) << x << " " << y;
  }
}

TEST(AlphaTest, TheCutoffItselfIsSolid) {
  scene::Scene scene = cut_square(scene::AlphaMode::kMask, 0.0f);
  scene.materials[0].base_color_texture.reset();
  scene.materials[0].base_color.a = 0.3f;
  scene.materials[0].alpha_cutoff = 0.3f;
  EXPECT_TRUE(accepts(scene, 0.7f, 0.2f));
  scene.materials[0].alpha_cutoff = 0.31f;
  EXPECT_FALSE(accepts(scene, 0.7f, 0.2f));
}

// Others reported this kind of fault: UniVRM 2031, qmuntal/gltf 98.
TEST(AlphaTest, VertexColoursAndFactorCountToo) {
  scene::Scene scene = cut_square(scene::AlphaMode::kMask, 1.0f);
  scene.meshes[0].colors = {{1, 1, 1, 1}, {1, 1, 1, 0}, {1, 1, 1, 0}, {1, 1, 1, 1}};  // fades along x
  EXPECT_TRUE(accepts(scene, 0.45f, 0.2f));
  EXPECT_FALSE(accepts(scene, 0.55f, 0.2f));
  scene.materials[0].base_color.a = 0.75f;
  EXPECT_FALSE(accepts(scene, 0.45f, 0.2f));
  EXPECT_TRUE(accepts(scene, 0.25f, 0.2f));
}

TEST(AlphaTest, AVeilStopsItsShareOfRays) {
  std::mt19937 random(run_seed() * 100 + 11);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  for (const float share : {0.2f, 0.5f, 0.9f}) {
    const scene::Scene scene = cut_square(scene::AlphaMode::kBlend, share);
    constexpr int kRays = 20000;
    int stopped = 0;
    for (int i = 0; i < kRays; ++i)
      stopped += accepts(scene, 0.51f + 0.48f * uniform(random), uniform(random), {uniform(random), 0.5f, 3}) ? 1 : 0;
    // Six standard deviations: one seed in half a billion fails.
    EXPECT_NEAR(double(stopped) / kRays, share, 6 * std::sqrt(share * (1 - share) / kRays) + 0.5 / 255);
    EXPECT_TRUE(accepts(scene, 0.3f, 0.7f));
  }
}

TEST(AlphaTest, RaysThroughOneTriangleAreIndependentOfAnother) {
  // Two alpha-blended surfaces one behind the other transmit (1 - alpha)^2, not 1 - alpha.
  std::mt19937 random(run_seed() * 100 + 12);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  int both = 0;
  constexpr int kRays = 20000;
  for (int i = 0; i < kRays; ++i) {
    Ray ray;
    ray.direction = {uniform(random), uniform(random), 1};
    both += blend_chance(ray, 0, 0) >= 0.5f && blend_chance(ray, 0, 1) >= 0.5f ? 1 : 0;
    both += blend_chance(ray, 0, 0) >= 0.5f && blend_chance(ray, 1, 0) >= 0.5f ? 1 : 0;
  }
  EXPECT_NEAR(both / (2.0 * kRays), 0.25, 0.02);
}

TEST(AlphaTest, TheAnswerIsAPureFunctionOfItsArguments) {
  const scene::Scene scene = cut_square(scene::AlphaMode::kBlend, 0.5f);
  for (float x = 0.505f; x < 1; x += 0.01f) {
    const bool first = accepts(scene, x, 0.3f);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(accepts(scene, x, 0.3f), first);
  }
}

TEST(AlphaTest, NothingAndEverythingAreExact) {
  scene::Scene scene = cut_square(scene::AlphaMode::kBlend, 0.0f);
  for (float x = 0.501f; x < 1; x += 0.001f) EXPECT_FALSE(accepts(scene, x, 0.3f));
  scene = cut_square(scene::AlphaMode::kBlend, 1.0f);
  for (float x = 0.501f; x < 1; x += 0.001f) EXPECT_TRUE(accepts(scene, x, 0.3f));
}

// A ray meets a blended sphere twice. Levels of accuracy give the points other last bits, which must not draw other
// numbers; the way in and the way out have a number each.
TEST(AlphaTest, ASphereIsMetByItsSideNotByTheBitsOfThePoint) {
  scene::Scene scene;
  scene.materials.emplace_back().alpha_mode = scene::AlphaMode::kBlend;
  scene.materials.back().base_color.a = 0.5f;
  scene.meshes.emplace_back().spheres.push_back({Vec3{0}, 1, MaterialId(0)});
  scene.instances.push_back({MeshId(0), {Mat3(Vec3{-1, 0.2f, 0}, Vec3{0, 0.7f, 0.1f}, Vec3{0.3f, 0, 1.3f}), Vec3{4}}});
  const AlphaTest alpha(scene);
  std::mt19937 random(run_seed() * 100 + 13);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  int in = 0, both = 0;
  constexpr int kRays = 4000;
  for (int i = 0; i < kRays; ++i) {
    Ray ray;
    ray.direction = {0.1f * uniform(random), 0.1f * uniform(random), 1};
    const Vec2 front = octahedral(DVec3(0.1 * uniform(random), 0, -1)), back = octahedral(DVec3(0, 0, 1));
    const auto accepts_at = [&](const Vec2& at) { return alpha.accepts(ray, 0, 0, at.x, at.y); };
    const bool first = accepts_at(front), second = accepts_at(back);
    ASSERT_EQ(accepts_at({std::nextafter(front.x, 2.0f), std::nextafter(front.y, -1.0f)}), first);
    ASSERT_EQ(accepts_at({std::nextafter(back.x, 2.0f), back.y}), second);
    in += first;
    both += first && second;
  }
  EXPECT_NEAR(in / double(kRays), 0.5, 0.05);
  EXPECT_NEAR(both / double(kRays), 0.25, 0.05);
}

TEST(Opacity, AsksOnlyWhereARayMayPass) {
  using scene::AlphaMode;
  const auto calls_any_hit = [](const scene::Scene& scene, std::uint32_t triangle = 0) {
    const scene::Opacity opacity(scene);
    const bool may = opacity.may_be_non_opaque(scene.meshes[0], triangle);
    EXPECT_TRUE(!may || opacity.any());
    return may;
  };
  EXPECT_FALSE(calls_any_hit(cut_square(AlphaMode::kOpaque, 0)));
  EXPECT_TRUE(calls_any_hit(cut_square(AlphaMode::kMask, 0.4f)));
  EXPECT_FALSE(calls_any_hit(cut_square(AlphaMode::kMask, 0.6f)));  // nowhere below the cutoff
  EXPECT_TRUE(calls_any_hit(cut_square(AlphaMode::kBlend, 0.6f)));
  EXPECT_FALSE(calls_any_hit(cut_square(AlphaMode::kBlend, 1)));
  scene::Scene faded = cut_square(AlphaMode::kBlend, 1);
  faded.meshes[0].colors = {Vec4{1}, Vec4{1, 1, 1, 0.5f}, Vec4{1}, Vec4{1}};
  EXPECT_TRUE(calls_any_hit(faded, 0));
  EXPECT_FALSE(calls_any_hit(faded, 1));  // vertices 0, 2, 3
}

TEST(Opacity, NeverCallsATriangleSolidThatLetsARayPass) {
  std::mt19937 random(run_seed() * 100 + 13);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  for (int i = 0; i < 2000; ++i) {
    scene::Scene scene = cut_square(i % 2 ? scene::AlphaMode::kMask : scene::AlphaMode::kBlend,
                                    uniform(random) < 0.3f ? 1.0f : uniform(random));
    scene.textures[0].linear_filter = uniform(random) < 0.5f;
    const float cutoff = scene.materials[0].alpha_cutoff = uniform(random);
    const float vertex = uniform(random) < 0.3f ? cutoff : 1.0f;
    if (uniform(random) < 0.5f) scene.meshes[0].colors.assign(4, Vec4{1, 1, 1, vertex});
    const scene::Opacity opacity(scene);
    const float x = uniform(random), y = uniform(random);
    const bool solid = accepts(scene, x, y), any_hit_calls = opacity.may_be_non_opaque(scene.meshes[0], y < x ? 0 : 1);
    EXPECT_TRUE(solid || any_hit_calls) << i;
  }
}

}  // namespace
}  // namespace carousel::shading
