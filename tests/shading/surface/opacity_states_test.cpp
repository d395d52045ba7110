// Opacity micromaps against the any-hit call, at points that lie close in their triangles and on the edges of
// micro-triangles.
#include "shading/surface/opacity_states.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "scene/model/opacity.h"
#include "shading/surface/alpha_test.h"
#include "tests/shading/path/small_scenes.h"
#include "tests/support/random_runs.h"

namespace carousel::shading {
namespace {

using scene::OpacityMicromaps;
using scene::OpacityState;

/// A square of two triangles with a picture of random blots, seen through random coordinates and a random sampler.
scene::Scene random_square(std::mt19937& random) {
  const auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  const auto one_of = [&](std::uint32_t n) { return random() % n; };
  scene::Scene scene = empty_scene();
  const std::uint32_t width = 1 + one_of(24), height = 1 + one_of(24);
  scene::Image image{"blots", width, height, std::vector<std::uint8_t>(4 * std::size_t{width} * height, 128)};
  const float grain = uniform(0.1f, 0.9f);
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const float blot = std::sin(grain * float(x)) + std::sin(grain * float(y) + 1);
      image.rgba[4 * (std::size_t{y} * width + x) + 3] = one_of(9) == 0 ? static_cast<std::uint8_t>(random())
                                                         : blot > 0     ? 255
                                                                        : 0;
    }
  scene.images.push_back(image);
  const auto wrap = [&] { return static_cast<scene::Wrap>(one_of(3)); };
  scene.textures.push_back({ImageId(0), wrap(), wrap(), one_of(2) == 0});
  scene::Material m = matte({1, 1, 1});
  m.alpha_mode = one_of(3) == 0 ? scene::AlphaMode::kBlend : scene::AlphaMode::kMask;
  const float cutoffs[] = {0, 0.25f, 0.5f, 1, 1.5f};
  m.alpha_cutoff = cutoffs[one_of(5)];
  m.base_color.a = one_of(2) == 0 ? 1 : uniform(0, 1.2f);
  scene::TextureUse& use = m.base_color_texture.emplace();
  if (one_of(2) == 0) {
    use.offset = {uniform(-2, 2), uniform(-2, 2)};
    use.scale = {uniform(-2, 2), uniform(-2, 2)};
    if (one_of(2) == 0) use.rotation = uniform(-4, 4);
  }
  add_quad(scene, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, add_material(scene, m));
  for (int corner = 0; corner < 4; ++corner) scene.meshes[0].uv0.push_back({uniform(-1, 2), uniform(-1, 2)});
  if (one_of(3) == 0)
    for (int corner = 0; corner < 4; ++corner) scene.meshes[0].colors.push_back({1, 1, 1, uniform(-0.2f, 1)});
  return scene;
}

struct Point {
  float u, v;
};

/// Points on a fine lattice, on its neighbours in float, and at random, some of them beyond the edges by rounding.
std::vector<Point> points(std::mt19937& random, int level) {
  std::vector<Point> out;
  const int steps = 4 << level;
  const auto near = [&](float x) {
    const float to[] = {-1, x, 2};
    return std::nextafter(x, to[random() % 3]);
  };
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; i + j <= steps; ++j) out.push_back({near(float(i) / float(steps)), near(float(j) / float(steps))});
  std::uniform_real_distribution<float> uniform(0, 1);
  for (int i = 0; i < 400; ++i) {
    const float u = uniform(random), v = uniform(random);
    out.push_back(u + v <= 1 ? Point{u, v} : Point{1 - u, 1 - v});
  }
  return out;
}

TEST(OpacityStates, KnowOnlyWhatTheAnyHitCallSays) {
  std::mt19937 random(run_seed() * 31 + 5);
  std::array<std::uint64_t, 3> found{};
  std::uint64_t lost = 0;
  for (int round = 0; round < 150; ++round) {
    const scene::Scene scene = random_square(random);
    const int level = static_cast<int>(random() % 5);
    const bool four = random() % 4 != 0;
    const OpacityMicromaps maps = make_micromaps(scene, level, four);
    if (!four) {
      EXPECT_EQ(maps.micro_unknown, 0u) << "one bit has no third state";
    }
    const AlphaTest alpha(scene);
    Ray ray;
    ray.origin = {0.5f, 0.5f, 3};
    ray.direction = {0.1f, 0.2f, -1};
    for (std::uint32_t triangle = 0; triangle < 2; ++triangle) {
      if (!scene::Opacity(scene).may_be_non_opaque(scene.meshes[0], triangle)) {
        EXPECT_EQ(maps.bytes_of(0, triangle), 0u);
        continue;
      }
      for (const Point& p : points(random, level)) {
        const OpacityState state = maps.state(0, triangle, p.u, p.v);
        ++found[static_cast<std::size_t>(state)];
        if (state == OpacityState::kUnknown) continue;
        for (const float turn : {0.1f, 0.3f, 0.7f}) {  // alpha-blended surfaces accept by chance
          ray.direction.x = turn;
          ASSERT_EQ(alpha.accepts(ray, 0, triangle, p.u, p.v), state == OpacityState::kOpaque)
              << "round " << round << ", level " << level << ": " << p.u << " " << p.v;
        }
      }
      lost += maps.unknown;
    }
  }
  for (const std::uint64_t count : found) EXPECT_GT(count, 1000u);
  EXPECT_GT(lost, 0u);
}

/// The micro-triangle that the barycentrics of all three corners name: its row, and the rows from the other two sides.
TEST(OpacityStates, NumberEachMicroTriangleOnce) {
  for (int level = 0; level <= 6; ++level) {
    const scene::MicroGrid grid{level};
    const int side = 1 << level;
    std::vector<int> seen(grid.count());
    for (int v = 0; v < side; ++v)
      for (int u = 0; u + v < side; ++u)
        for (const bool upper : {false, true}) {
          if (upper && u + v + 1 == side) continue;
          const float third = (upper ? 2.0f : 1.0f) / 3;  // its centre
          const std::uint32_t number =
              grid.number_at((float(u) + third) / float(side), (float(v) + third) / float(side));
          ASSERT_LT(number, grid.count());
          EXPECT_EQ(number, grid.number(std::uint32_t(u), std::uint32_t(v), upper));
          ++seen[number];
        }
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), side * side) << level;
  }
}

/// A picture whose left half is opaque and whose right half is transparent, on a square that it covers.
scene::Scene halves(bool linear, std::uint32_t width) {
  scene::Scene scene = empty_scene();
  scene::Image image{"halves", width, 1, std::vector<std::uint8_t>(4 * std::size_t{width}, 0)};
  for (std::uint32_t x = 0; x < width / 2; ++x) image.rgba[4 * x + 3] = 255;
  scene.images.push_back(image);
  scene.textures.push_back({ImageId(0), scene::Wrap::kClamp, scene::Wrap::kClamp, linear});
  scene::Material m = matte({1, 1, 1});
  m.alpha_mode = scene::AlphaMode::kMask;
  m.base_color_texture.emplace();
  add_quad(scene, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, add_material(scene, m));
  scene.meshes[0].uv0 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  return scene;
}

// At level 2 four columns of micro-triangles meet the line in the middle, in two rows on each side of the diagonal.
TEST(OpacityStates, AreUnknownAlongTheEdgesOfThePictureAlone) {
  const OpacityMicromaps maps = make_micromaps(halves(false, 2), 2, true);
  EXPECT_EQ(maps.maps(), 2u);
  EXPECT_EQ(maps.map_bytes(), 4u);
  EXPECT_EQ(maps.size_bytes(), 2 * (4u + 4u));
  EXPECT_EQ(maps.micro_opaque + maps.micro_transparent + maps.micro_unknown, 32u);
  // Those that touch the line in an edge or a corner are not known, as hits on it belong to one half.
  EXPECT_EQ(maps.micro_opaque, maps.micro_transparent);
  EXPECT_GT(maps.micro_opaque, 4u);
  EXPECT_LE(maps.micro_unknown, 16u);
  // Finer ones know nearly all.
  const OpacityMicromaps fine = make_micromaps(halves(false, 2), 6, true);
  EXPECT_LT(fine.micro_unknown, 6u * 64);
  // Two states have no map for a triangle with an edge, and all of it in its index.
  const OpacityMicromaps two = make_micromaps(halves(false, 2), 6, false);
  EXPECT_EQ(two.maps(), 0u);
  EXPECT_EQ(two.unknown, 2u);
  EXPECT_EQ(two.size_bytes(), 8u);
}

TEST(OpacityStates, AreTheTrianglesWhereNothingVaries) {
  scene::Scene scene = halves(true, 8);
  scene.meshes[0].uv0 = {{0.1f, 0.5f}, {0.2f, 0.5f}, {0.3f, 0.5f}, {0.1f, 0.5f}};
  const OpacityMicromaps opaque = make_micromaps(scene, 4, true);
  EXPECT_EQ(opaque.opaque, 2u);
  EXPECT_EQ(opaque.size_bytes(), 8u);
  EXPECT_EQ(opaque.state(0, 0, 0.25f, 0.25f), OpacityState::kOpaque);
  for (Vec2& uv : scene.meshes[0].uv0) uv.x = 1 - uv.x;
  const OpacityMicromaps transparent = make_micromaps(scene, 4, false);
  EXPECT_EQ(transparent.transparent, 2u);
  EXPECT_EQ(transparent.state(0, 1, 0.25f, 0.25f), OpacityState::kTransparent);
}

}  // namespace
}  // namespace carousel::shading
