// Work that a machine built for 32 bits does in 64 takes four passes through its units.
#include <gtest/gtest.h>

#include "accel/transform/instance_data.h"
#include "ringbus/cycle/shapes/shape_memory.h"
#include "ringbus/cycle/testers/tester.h"
#include "tests/accel/structure/placements.h"
#include "tests/accel/structure/test_scenes.h"

namespace carousel::ringbus::cycle {
namespace {

Cycle end_of(const IntersectionCounts& counts) {
  return Tester(TestersConfig{}).strip(1000, counts);
}

TEST(PassesInDouble, ATriangleThatIsMetTakesFourMore) {
  EXPECT_EQ(end_of({.triangle = 9, .refined = 2}), end_of({.triangle = 9 + 4 * 2}));
  EXPECT_EQ(Tester(TestersConfig{}).ray(1000, IntersectionCounts{.triangle = 16, .refined = 16}),
            Tester(TestersConfig{}).ray(1000, IntersectionCounts{.triangle = 16 + 4 * 16}));
}

// Eight leaves of sixteen triangles in a mixed node, all met: more than a byte holds, and none of them free.
TEST(PassesInDouble, AMixedNodeMayTakeHundreds) {
  const TestersConfig config;
  EXPECT_EQ(Tester(config).ray(1000, IntersectionCounts{.triangle = 128, .refined = 128}),
            1000 + 5 * 128 - 1 + config.units[UnitKind::kTriangle].latency_cycles);
}

TEST(PassesInDouble, ATransformForANearlySingularInstanceTakesFour) {
  EXPECT_EQ(end_of({.transforms = 5, .transforms_in_double = 5}), end_of({.transforms = 4 * 5}));
  const std::uint64_t inversion = accel::kInversionPasses;
  EXPECT_EQ(inversion_passes({.transforms = 5, .inversions = 1}), inversion);
  EXPECT_EQ(inversion_passes({.transforms = 5, .inversions = 1, .inversions_in_double = 1}), 4 * inversion);
}

// US 12394134, paragraph 25: 39 products for the inverse of the whole matrix, 30 for the two steps, 18 in a pass.
TEST(PassesInDouble, TheWholeInverseTakesAPassMore) {
  EXPECT_EQ(inversion_passes({.transforms = 5, .inversions = 1}), 2u);
  EXPECT_EQ(inversion_passes({.transforms = 5, .inversions = 1, .full_inversions = 1}), 3u);
}

TEST(PassesInDouble, ItsInverseTakes84Bytes) {
  scene::Scene scene = accel::icosphere_scene(1);
  scene.instances[0].world_from_model = accel::rotate_scale_translate({1, 2, 3}, 40, {1, 1, 1}, {1, 2, 3});
  const DMat3 thin = accel::rotation({1, 2, 3}, 40) * DMat3(1, 0, 0, 0, 1e-6, 0, 0, 0, 1);
  accel::add_instance(scene, 0, {Mat3(thin), Vec3(4)});
  const accel::Accel accel = accel::build_sequential(scene);
  EXPECT_EQ(accel.promoted_instances, 1u);
  const ShapeMemory memory(accel, AccuracyConfig{});
  EXPECT_EQ(memory.transform(0).bytes, 48u);
  EXPECT_EQ(memory.transform(1).bytes, 84u);
  EXPECT_EQ(memory.transform(1).address - memory.transform(0).address, 128u);
}

}  // namespace
}  // namespace carousel::ringbus::cycle
