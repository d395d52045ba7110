// Vertices on a grid: exact, nearest, and as many steps as the key says.
#include "scene/model/quantise.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "scene/builtin/builtin.h"

namespace carousel::scene {
namespace {

Scene cloud(const Vec3& centre, const Vec3& size) {
  std::mt19937 random(2);
  const auto part = [&] { return static_cast<float>(random() % 65537) / 65536 - 0.5f; };
  Scene scene;
  Mesh& mesh = scene.meshes.emplace_back();
  for (int i = 0; i < 500; ++i) mesh.positions.push_back(centre + size * Vec3{part(), part(), part()});
  return scene;
}

/// The largest power of two of which all coordinates are multiples.
double grid_of(const Mesh& mesh) {
  for (int exponent = 40; exponent > -150; --exponent) {
    const double step = std::ldexp(1.0, exponent);
    bool all = true;
    for (const Vec3& p : mesh.positions)
      for (int axis = 0; axis < 3; ++axis) all &= std::fmod(static_cast<double>(p[axis]), step) == 0;
    if (all) return step;
  }
  return 0;
}

TEST(Quantise, MovesVerticesToTheNearestPoints) {
  for (const int bits : {1, 8, 16, 24}) {
    const Scene before = cloud({0.1f, -0.2f, 0.3f}, {7, 3, 1});
    Scene after = before;
    quantise(after, bits);
    const double step = std::ldexp(8.0, -bits);  // 7 is between 4 and 8
    EXPECT_GE(grid_of(after.meshes[0]), step) << bits;
    double farthest = 0;
    for (std::size_t i = 0; i < before.meshes[0].positions.size(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        farthest = std::max(farthest, std::abs(static_cast<double>(before.meshes[0].positions[i][axis]) -
                                               after.meshes[0].positions[i][axis]));
    EXPECT_LE(farthest, step / 2) << bits;
    if (bits < 20) {
      EXPECT_GT(farthest, step / 8) << bits;
    }
    Scene again = after;
    quantise(again, bits);
    EXPECT_EQ(again.meshes[0].positions, after.meshes[0].positions) << bits;
  }
}

TEST(Quantise, KeepsToNumbersThatFloatsHold) {
  Scene far = cloud({1e6f, 0, 0}, {1, 1, 1});
  quantise(far, 24);
  EXPECT_EQ(grid_of(far.meshes[0]), std::ldexp(1.0, 20 - 24));  // 2^20 is above 1e6
  Scene tiny = cloud({0, 0, 0}, {1e-42f, 1e-42f, 0});
  quantise(tiny, 24);
  for (const Vec3& p : tiny.meshes[0].positions) EXPECT_TRUE(std::isfinite(p.x) && !std::signbit(p.z));
}

TEST(Quantise, LeavesAPointAndSpheresAlone) {
  Scene scene;
  scene.meshes.emplace_back().positions.assign(3, Vec3{0.1f, 0.2f, 0.3f});
  scene.meshes.emplace_back().spheres.push_back({Vec3{0.1f}, 0.7f, {}});
  quantise(scene, 3);
  EXPECT_EQ(scene.meshes[0].positions[2], (Vec3{0.1f, 0.2f, 0.3f}));
  EXPECT_EQ(scene.meshes[1].spheres[0].center, Vec3{0.1f});
}

}  // namespace
}  // namespace carousel::scene
