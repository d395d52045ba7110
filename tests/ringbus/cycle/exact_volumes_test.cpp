// The fall-back of accuracy.triangle: exact is counted by the kernels and charged to the triangle units.
#include <gtest/gtest.h>

#include "accel/exact/exact_triangle.h"
#include "accel/traverse/reference_tracer.h"
#include "ringbus/cycle/testers/tester.h"
#include "ringbus/verdict/what_if.h"
#include "tests/core/config/config_issues.h"
#include "tests/ringbus/support/test_machine.h"

namespace carousel::ringbus::cycle {
namespace {

TestersConfig testers() {
  TestersConfig c;
  c.units[UnitKind::kTriangle] = {4, 4, 4};  // in 64 bits
  return c;
}

TEST(ExactFallback, TakesEightTestsAVolume) {
  Tester tester(testers());
  // 4 + 3 x 8 tests in 7 turns of 4 cycles.
  EXPECT_EQ(tester.strip(100, {.triangle = 4, .exact_volumes = 3}), 100 + 6 * 4 + 4);
  EXPECT_EQ(tester.bank(UnitKind::kTriangle).busy(), 7 * 4);
  EXPECT_EQ(tester.strip(200, {.triangle = 4}), 204);
}

TEST(ExactFallback, OfASingleRayComesBehindItsTests) {
  Tester tester(testers());
  // One turn for the tests, then 8 in two turns, though the first turn left three units idle.
  EXPECT_EQ(tester.ray(100, IntersectionCounts{.triangle = 1, .exact_volumes = 1}), 100 + 2 * 4 + 4);
  EXPECT_EQ(tester.bank(UnitKind::kTriangle).busy(), 3 * 4);
}

TEST(ExactFallback, IsTakenAtEdgesOnly) {
  const std::array<Vec3, 3> corners{Vec3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  accel::NearestCrossing crossing;
  const auto volumes = [&](const Vec3& at) {
    Ray ray;
    ray.origin = at + Vec3{0, 0, 1};
    ray.direction = {0, 0, -1};
    const std::uint64_t before = accel::exact_volumes();
    EXPECT_TRUE(accel::exact_triangle(ray, corners, crossing));
    return accel::exact_volumes() - before;
  };
  EXPECT_EQ(volumes({0.25f, 0.25f, 0}), 0u);
  EXPECT_GE(volumes({0.5f, 0.5f, 0}), 1u);
  EXPECT_LE(volumes({0, 0, 0}), 4u);
}

TEST(TesterLimited, LiftsAllButTheTestUnits) {
  Config config = parse_config("scene: {builtin: cornell}\n", "machine.yaml");
  config.engine.kind = EngineKind::kCycle;
  config.topology.resources = 4;
  const Config relaxed = tester_limited(config);
  for (const UnitKindRow& row : kUnitKinds) {
    EXPECT_EQ(relaxed.testers.units[row.kind].units, config.testers.units[row.kind].units) << row.key;
    EXPECT_EQ(relaxed.testers.units[row.kind].latency_cycles, config.testers.units[row.kind].latency_cycles) << row.key;
  }
  EXPECT_EQ(relaxed.topology.resources, 4);
  EXPECT_EQ(relaxed.topology.shape, config.topology.shape);
  EXPECT_EQ(relaxed.collections.partial, config.collections.partial);
  EXPECT_EQ(relaxed.memory.dram_bytes_per_cycle, 64 * config.memory.dram_bytes_per_cycle);
  EXPECT_EQ(relaxed.memory.shape_buffer_kib, 64 * config.memory.shape_buffer_kib);
  EXPECT_EQ(relaxed.topology.link.latency_cycles, 1);
  EXPECT_EQ(relaxed.testers.contexts, 64);  // the end of its range
  EXPECT_EQ(relaxed.rays.slots_per_resource, 4 * config.rays.slots_per_resource);
  EXPECT_GT(shader_workers(relaxed), 16 * shader_workers(config));
}

}  // namespace
}  // namespace carousel::ringbus::cycle
