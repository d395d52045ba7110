// Rays that go through a treelet in lists find what the depth-first tracer finds, however long the lists are.
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/config/load/load.h"
#include "tests/accel/traverse/levels.h"
#include "tests/accel/traverse/simd_guard.h"
#include "tests/ringbus/identity/scenes.h"
#include "tests/ringbus/support/test_machine.h"
#include "tests/support/random_runs.h"

namespace carousel::ringbus {
namespace {

struct LanesCase {
  std::string scene;      // keys of the section
  bool non_opaque;        // rays with flags, and primitives that let some of them pass
  std::string structure;  // keys of the section `bvh`
};

const std::vector<LanesCase> kLanesCases{
    {"builtin: cornell", false, "width: 2, leaf_triangles: 1"},
    {"builtin: terrain", false, "width: 8, leaf_triangles: 4"},
    {"builtin: instances", true, "width: 4, leaf_triangles: 1"},
    {"builtin: instances, levels: 5", false, "width: 8, leaf_triangles: 4"},
    {"builtin: instances", false, "width: 8, leaf_triangles: 1, merge: world"},
    {"builtin: spheres", true, "width: 8, leaf_triangles: 16, mixed_triangles: 2"},
};

Cell cell_of(const LanesCase& row, const AccuracyConfig& accuracy, const char* lanes, int rays,
             SimdTarget simd = SimdTarget::kAuto) {
  const std::string text = fmt::format(
      "scene: {{{}}}\n"
      "engine: {{kind: native, lanes: {}, simd: {}}}\n"
      "topology: {{resources: {}}}\n"
      "accuracy: {{triangle: {}, box: {}}}\n"
      "collections: {{traversal: treelet}}\n"
      "bvh: {{treelet_triangles: 100000, {}}}\n"
      "rays: {{slots_per_resource: 256}}\n"
      "packets: {{rays: {}}}\n",
      row.scene, lanes, enum_name(simd), 1 + rays % 2, enum_name(accuracy.triangle), enum_name(accuracy.box),
      row.structure, rays);
  Cell cell{load_config({text, "machine.yaml"}).config, 1};
  cell.non_opaque = row.non_opaque;
  return cell;
}

// Closest hits, any hits, and hits that some rays pass, at every level of accuracy; lists that are never split (1, 7),
// that are split once (8, 9) and more often; as many rays in a register as each SIMD target has lanes.
TEST(RayLists, EqualTheDepthFirstTracerWithListsOfAnyLength) {
  Scenes scenes;
  std::vector<std::pair<LanesCase, AccuracyConfig>> cases;
  for (const LanesCase& row : kLanesCases)
    for (const AccuracyConfig& accuracy : accel::triangle_and_box_levels()) cases.emplace_back(row, accuracy);
  const std::vector<SimdTarget> targets = accel::usable_simd_targets();
  std::size_t next = 0;
  for (const auto& [row, accuracy] : some(cases, 24))
    for (const int rays : {1, 7, 8, 9, 16, 17, 100})
      for (const char* lanes : {"boxes", "rays", "auto"}) {
        const Cell cell = cell_of(row, accuracy, lanes, rays, targets[next++ % targets.size()]);
        EXPECT_EQ(run_cell(scenes.of(cell), cell).fault, "") << cell.text();
      }
}

// The key does what it says: the nodes of lists are met in another order than those of single rays, which shows in the
// numbers of tests.
TEST(RayLists, ChangeTheOrderOfTests) {
  Scenes scenes;
  const auto boxes = [&](const char* lanes, int rays, SimdTarget simd = SimdTarget::kAuto) {
    const Cell cell = cell_of(kLanesCases[1], {}, lanes, rays, simd);
    const Outcome out = run_cell(scenes.of(cell), cell);
    EXPECT_EQ(out.fault, "") << cell.text();
    return out.sum.tests.box;
  };
  const std::uint64_t one_by_one = boxes("boxes", 100);
  EXPECT_EQ(boxes("auto", 8), boxes("boxes", 8));
  for (const SimdTarget target : accel::usable_simd_targets()) {
    const accel::SimdGuard guard;
    accel::select_simd_target(target);
    if (accel::has_lists()) continue;
    EXPECT_EQ(boxes("rays", 100, target), one_by_one) << enum_name(target);
  }
  if (!accel::has_lists()) GTEST_SKIP() << "lists need registers of sixteen floats";
  EXPECT_NE(boxes("rays", 100), one_by_one);
  EXPECT_NE(boxes("auto", 100), one_by_one);
  EXPECT_LT(static_cast<double>(boxes("rays", 100)), 1.2 * static_cast<double>(one_by_one));
}

}  // namespace
}  // namespace carousel::ringbus
