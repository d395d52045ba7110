// The time that any-hit calls take under virtual time: a trip to the unit, or to a shader worker and back.
#include <gtest/gtest.h>

#include "accel/builders/build.h"
#include "tests/accel/structure/passing_scenes.h"
#include "tests/ringbus/support/test_machine.h"

namespace carousel::ringbus {
namespace {

// With one resource and one context nothing else waits.
TEST(AnyHitTime, IsTheTripToAWorkerAndBack) {
  const accel::HashedStop never(0);  // an any-hit call at each alpha-blended triangle
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
  config.topology.link.bytes_per_cycle = 64;  // the question, of 52 bytes, leaves in a cycle
  config.engine.kind = EngineKind::kCycle;
  // All three answers come at once: three tests, and four passes each for their distances in 64 bits.
  config.testers.units[UnitKind::kTriangle].units = 15;
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
  const Cycle at_once = cycles();
  config.testers.units[UnitKind::kAnyHit] = {1, 1, 21};
  EXPECT_EQ(cycles() - at_once, 20u);
  config.testers.units[UnitKind::kAnyHit] = {1, 10, 1};
  EXPECT_EQ(cycles() - at_once, 18u) << "two more of the three wait for the unit, nine cycles longer each";
  config.testers.units[UnitKind::kAnyHit] = {3, 1, 1};
  EXPECT_EQ(at_once - cycles(), 2u);

  config.testers.any_hit = TestersConfig::AnyHit::kShader;
  config.shading.cycles_per_any_hit = 0;
  const Cycle trip = cycles();
  const auto hop = static_cast<Cycle>(config.topology.link.latency_cycles);
  EXPECT_EQ(trip, at_once - 3 + 2 * hop) << "instead of three cycles in the unit";
  config.shading.cycles_per_any_hit = 7;
  EXPECT_EQ(cycles() - trip, 3u * 7u);

  // A program in place of the constant: seven instructions a call, which wait for nothing.
  config.programs.shaders.named["one"].program = {"load a, 1"};
  std::vector<std::string>& own = config.programs.shaders.named["own"].program;
  for (int i = 0; i < 7; ++i) own.push_back("load r" + std::to_string(i) + ", 1");
  config.shading.program.standard = "one";
  config.shading.program.of_kind[kAnyHitKind] = "constant";
  const Cycle constant = cycles();
  config.shading.program.of_kind[kAnyHitKind] = "own";
  EXPECT_EQ(cycles(), constant);
  own.push_back("sqrt r0, r0");
  own.push_back("add r1, r0, r0");
  EXPECT_EQ(cycles() - constant, 3u * (16u + 1u)) << "the sum waits for the root";
  config.shading.lanes = 3;
  EXPECT_EQ(cycles() - constant, (16u + 1u) + 7u - 3u * 7u) << "the three calls side by side";
}

}  // namespace
}  // namespace carousel::ringbus
