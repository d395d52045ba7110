// Accuracy keys may change the hits; engines may not: at every level both have the reference tracer's digest.
#include <set>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "accel/build/build.h"
#include "tests/ringbus/support/test_machine.h"

namespace carousel::ringbus {
namespace {

ScatterWorkload rays_into(const Aabb& bounds) {
  return ScatterWorkload(bounds, 300, 3, 6 + run_seed(), 50.0f);
}

std::string engine_digest(const Config& c, const accel::Accel& accel, const Aabb& bounds) {
  const float size = std::sqrt(glm::dot(bounds.extent(), bounds.extent()));
  const auto run = c.engine.kind == EngineKind::kCycle ? run_cycle : run_native;
  ScatterWorkload workload = rays_into(bounds);
  run(c, accel, size, workload, on_threads(2));
  return workload.digest().hex();
}

TEST(AccuracyIdentity, EveryTransformLevelHasOneDigest) {
  scene::Scene scene = builtin_scene(BuiltinScene::kInstances, 0, 400);
  for (std::size_t i = 0; i < scene.instances.size(); i += 2) {  // every other one without its scale: a rotation
    Mat3& linear = scene.instances[i].world_from_model.linear;
    for (int c = 0; c < 3; ++c) linear[c] = Vec3(glm::normalize(DVec3(linear[c])));
  }
  const Aabb bounds = scene.bounds();
  std::set<std::string> digests;
  for (const auto& level : kEnumNames<TransformLevel>) {
    Config c;
    c.accuracy.transform = level.value;
    c.topology.resources = 4;
    c.bvh.treelet_triangles = 200;
    c.rays.slots_per_resource = 64;
    const accel::Accel accel = accel::build(scene, c.bvh, *make_sequential_executor(), c.accuracy);
    ScatterWorkload reference = rays_into(bounds);
    accel::run_reference(accel, reference);
    digests.insert(reference.digest().hex());
    for (const EngineKind kind : {EngineKind::kNative, EngineKind::kCycle}) {
      for (const auto& traversal : kEnumNames<Traversal>) {
        c.engine.kind = kind;
        c.collections.traversal = traversal.value;
        EXPECT_EQ(engine_digest(c, accel, bounds), reference.digest().hex())
            << level.name << " " << enum_name(kind) << " " << traversal.name << " CAROUSEL_SEED=" << run_seed();
      }
    }
  }
  EXPECT_EQ(digests.size(), kEnumNames<TransformLevel>.size());  // each level is an arithmetic of its own
}

}  // namespace
}  // namespace carousel::ringbus
