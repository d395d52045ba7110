// With real shading every native machine gives one digest of the hits and one of the image a scene.
#include <gtest/gtest.h>

#include "accel/builders/build.h"
#include "shading/tracer/path_tracer.h"
#include "tests/ringbus/identity/machine_space.h"

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

  std::vector<std::string> with{"engine.kind=native",        "test.non_opaque=false",
                                "test.storage=ample",        "test.link_faults=false",
                                "faults.resource.kind=none", "accuracy.triangle=watertight",
                                "accuracy.box=conservative", "accuracy.transform=two_step"};
  if (kThreadSanitizer) with.push_back("engine.threads=2");
  for (std::uint32_t seed = 1; seed <= static_cast<std::uint32_t>(cell_count(12)); ++seed) {
    std::mt19937 random(seed * 31 + salt);
    Cell cell = all_machines().draw_cell(random, with);
    Config& c = cell.config;
    c.image = picture.image;
    const accel::Accel accel = accel::build(scene, c.bvh, *make_sequential_executor(), c.accuracy, c.cull_planes);
    c.collections.capacity =
        std::max<std::int64_t>(minimum_capacity(c, accel.most_ways(), accel.levels()), 4 * c.packets.rays);
    // Few paths at a time, many at a time.
    shading::PathTracer tracer(scene, c, seed % 2 ? 1000 : 5, static_cast<std::size_t>(shader_workers(c)));
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
