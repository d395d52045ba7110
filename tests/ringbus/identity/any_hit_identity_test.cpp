// What lets rays through, spheres and rays' wishes: one digest, in the tracer, on the native ring and on the cycle
// engine, wherever it is asked.
#include <gtest/gtest.h>

#include "accel/build/build.h"
#include "accel/traverse/brute_force.h"
#include "tests/accel/structure/passing_scenes.h"
#include "tests/ringbus/identity/factors.h"
#include "tests/ringbus/identity/identity_cells.h"

namespace carousel::ringbus {
namespace {

void expect_one_digest(const std::vector<Factor>& factors, std::uint32_t number) {
  const accel::HashedStop stop(0.4);
  std::uint64_t any_hit_calls = 0, procedural = 0;
  for (const BuiltinScene builtin : {BuiltinScene::kSpheres, BuiltinScene::kInstances}) {
    TestScene scene(accel::passing_scene(builtin, 20, run_seed()), 150, 3, 0.5f, {}, &stop);
    std::mt19937 random(number + 7919 * run_seed());
    for (int i = 0; i < cell_count(40); ++i) {
      std::vector<int> row(factors.size());
      do {
        for (std::size_t f = 0; f < row.size(); ++f) row[f] = static_cast<int>(random() % factors[f].levels.size());
      } while (!possible(cell_of(factors, row).config));
      Cell cell = cell_of(factors, row);
      if (cell.config.engine.kind == EngineKind::kCycle) cell.threads = 1;
      if (i % 3 == 1) cell.config.cull_planes.count = 4;
      const Outcome outcome = run_cell(scene, cell);
      EXPECT_EQ(outcome.fault, "") << "CAROUSEL_SEED=" << run_seed() << " " << cell.text();
      any_hit_calls += outcome.sum.tests.any_hit_calls;
      procedural += outcome.sum.tests.procedural;
    }
  }
  EXPECT_GT(any_hit_calls, 1000u);
  EXPECT_GT(procedural, 1000u);
}

TEST(AnyHitIdentity, NativeRingGivesTheTracersDigest) {
  expect_one_digest(machine_factors(), 5);
}
TEST(AnyHitIdentity, CycleEngineGivesTheTracersDigest) {
  expect_one_digest(cycle_factors(), 6);
}

TEST(AnyHitIdentity, BundlesChangeNothing) {
  const accel::HashedStop stop(0.4);
  TestScene scene(accel::passing_scene(BuiltinScene::kSpheres, 20, run_seed()), 150, 3, 0.5f, {}, &stop);
  for (const EngineKind kind : {EngineKind::kNative, EngineKind::kCycle})
    for (const std::int64_t size : {4, 16})
      for (const auto any_hit : {TestersConfig::AnyHit::kInline, TestersConfig::AnyHit::kShader}) {
        Cell cell;
        cell.config.engine.kind = kind;
        cell.config.bundles.size = size;
        cell.config.bundles.builder.threshold = 100;
        cell.config.testers.any_hit = any_hit;
        const Outcome outcome = run_cell(scene, cell);
        EXPECT_EQ(outcome.fault, "") << cell.text();
        EXPECT_GT(outcome.sum.bundles.size(), 0u);
      }
}

// One resource, one context, nothing else to wait for: the time that asking takes is the trip and the worker's.
TEST(AnyHitTime, IsTheTripToAWorkerAndBack) {
  const accel::HashedStop never(0);  // every ray asks at each triangle of the veil in front of it
  scene::Scene blended = accel::empty_scene();
  blended.materials[0].alpha_mode = scene::AlphaMode::kBlend;
  blended.materials[0].base_color.a = 0.5f;
  scene::Mesh mesh;
  for (int i = 0; i < 3; ++i) {
    const float z = static_cast<float>(i);
    for (const Vec3& p : {Vec3{-9, -9, z}, Vec3{9, -9, z}, Vec3{0, 9, z}}) {
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(p);
    }
  }
  accel::add_instance(blended, accel::add_mesh(blended, mesh));
  Config config;
  config.topology.resources = 1;
  config.engine.kind = EngineKind::kCycle;
  accel::Accel accel = accel::build(blended, config.bvh, *make_sequential_executor());
  accel.any_hit = &never;
  ASSERT_TRUE(accel.calls_any_hit());

  struct OneRay final : Workload {
    Generated generate(WorkerId, std::size_t, RayBatch& out) override {
      if (done) return {0, true};
      out.push_back(accel::ray_to({0, 0, 9}, {0, 0, -1}));
      done = true;
      return {1, true};
    }
    void shade(WorkerId, const HitBatch& completed, RayBatch&) override { hits += completed[0].hit.valid(); }
    bool done = false;
    int hits = 0;
  };
  const auto cycles = [&] {
    OneRay ray;
    const RunResult result = run_cycle(config, accel, 10, ray, on_threads(1));
    EXPECT_EQ(ray.hits, 0);
    EXPECT_EQ(result.resources[0].tests.any_hit_calls, 3u);
    return result.cycle->cycles;
  };
  config.testers.units[UnitKind::kAnyHit] = {1, 1, 1};
  const cycle::Cycle at_once = cycles();
  config.testers.units[UnitKind::kAnyHit] = {1, 1, 21};
  EXPECT_EQ(cycles() - at_once, 20u);
  config.testers.units[UnitKind::kAnyHit] = {1, 10, 1};
  EXPECT_EQ(cycles() - at_once, 18u) << "two more of the three wait for the unit, nine cycles longer each";
  config.testers.units[UnitKind::kAnyHit] = {3, 1, 1};
  EXPECT_EQ(at_once - cycles(), 2u);

  config.testers.any_hit = TestersConfig::AnyHit::kShader;
  config.shading.cycles_per_any_hit = 0;
  const cycle::Cycle trip = cycles();
  const auto hop = static_cast<cycle::Cycle>(config.topology.link.latency_cycles);
  EXPECT_EQ(trip, at_once - 3 + 2 * hop) << "instead of three cycles in the unit";
  config.shading.cycles_per_any_hit = 7;
  EXPECT_EQ(cycles() - trip, 3u * 7u);
}

}  // namespace
}  // namespace carousel::ringbus
