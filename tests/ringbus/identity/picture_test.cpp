// The same with real shading: one hits digest and one image digest a scene, whatever the machine.
#include <gtest/gtest.h>

#include "accel/build/build.h"
#include "shading/tracer/path_tracer.h"
#include "tests/ringbus/identity/factors.h"

namespace carousel::ringbus {
namespace {

void expect_one_picture(BuiltinScene builtin, std::uint32_t salt) {
  const scene::Scene scene = builtin_scene(builtin, 2000, 60);
  const Aabb bounds = scene.bounds();
  const Vec3 e = bounds.extent();
  const float size = std::sqrt(e.x * e.x + e.y * e.y + e.z * e.z);
  Config picture;
  picture.image = {12, 9, 2, 4, 3};
  shading::PathTracer reference(scene, picture, 1000, 1);
  accel::run_reference(accel::build(scene, BvhConfig{}, *make_sequential_executor()), reference);

  const std::vector<Factor> factors = machine_factors();
  for (std::uint32_t seed = 1; seed <= static_cast<std::uint32_t>(cell_count(12)); ++seed) {
    std::mt19937 random(seed * 31 + salt);
    Cell cell;
    do {
      cell = Cell{picture};
      for (const Factor& f : factors) f.levels[random() % f.levels.size()](cell);
    } while (!possible(cell.config));
    Config& c = cell.config;
    const accel::Accel accel = accel::build(scene, c.bvh, *make_sequential_executor());
    c.collections.capacity =
        std::max<std::int64_t>(minimum_capacity(c, accel.width, accel.max_depth), 4 * c.packets.rays);
    // Few paths at a time, many at a time.
    shading::PathTracer tracer(scene, c, seed % 2 ? 1000 : 5, static_cast<std::size_t>(c.shading.workers));
    run_native(c, accel, size, tracer, on_threads(cell.threads));
    EXPECT_EQ(tracer.hits_digest().hex(), reference.hits_digest().hex()) << "seed " << seed << ": " << cell.text();
    EXPECT_EQ(tracer.image_digest(), reference.image_digest()) << "seed " << seed << ": " << cell.text();
    EXPECT_EQ(tracer.counts().paths, 12u * 9 * 2);
  }
}

TEST(Picture, OfCornellIsOne) {
  expect_one_picture(BuiltinScene::kCornell, 1);
}
TEST(Picture, OfTerrainIsOne) {
  expect_one_picture(BuiltinScene::kTerrain, 2);
}
TEST(Picture, OfSpheresIsOne) {
  expect_one_picture(BuiltinScene::kSpheres, 3);
}
TEST(Picture, OfInstancesIsOne) {
  expect_one_picture(BuiltinScene::kInstances, 4);
}

}  // namespace
}  // namespace carousel::ringbus
