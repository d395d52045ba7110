// With planes or without: one digest, in the tracer, on the native ring and on the cycle engine.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/ringbus/identity/factors.h"
#include "tests/ringbus/identity/identity_cells.h"

namespace carousel::ringbus {
namespace {

using Nodes = CullPlanesConfig::Nodes;
using Fit = CullPlanesConfig::Fit;
using PlaneOrder = CullPlanesConfig::Order;
using Levels = CullPlanesConfig::Levels;

std::vector<CullPlanesConfig> all_planes() {
  std::vector<CullPlanesConfig> all;
  for (const std::int64_t count : {1, 2, 4, 8})
    for (const Nodes nodes : {Nodes::kLeaves, Nodes::kInner, Nodes::kAll})
      for (const Fit fit : {Fit::kVertices, Fit::kBoxes})
        all.push_back({count, nodes, all.size() % 3 == 2, fit,
                       all.size() % 5 < 2 ? PlaneOrder::kPlanesFirst : PlaneOrder::kBoxFirst,
                       std::array{Levels::kAll, Levels::kBlas, Levels::kTlas, Levels::kAll}[all.size() % 4]});
  return all;
}

std::string text(const CullPlanesConfig& planes) {
  return fmt::format("{} planes, nodes {}, fit {}, levels {}, {}{}", planes.count, enum_name(planes.nodes),
                     enum_name(planes.fit), enum_name(planes.levels), enum_name(planes.order),
                     planes.shared_normals ? ", shared" : "");
}

std::vector<TestScene> plane_scenes() {
  std::vector<TestScene> all;
  all.emplace_back(builtin_scene(BuiltinScene::kInstances, 0, 300), 150, 3);
  all.emplace_back(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 150, 3);
  all.emplace_back(builtin_scene(BuiltinScene::kSpheres, 3000, 0), 150, 3);
  all.emplace_back(builtin_scene(BuiltinScene::kSliver, 300, 0), 100, 2);
  return all;
}

/// Each way to have planes on a machine drawn for it; somewhere they must cull.
void expect_one_plane_digest(const std::vector<Factor>& factors, std::uint32_t number) {
  std::uint64_t culled = 0, transforms_spared = 0;
  for (TestScene& scene : plane_scenes()) {
    std::mt19937 random(number + 7919 * run_seed());
    for (const CullPlanesConfig& planes : all_planes()) {
      std::vector<int> row(factors.size());
      do {
        for (std::size_t f = 0; f < row.size(); ++f) row[f] = static_cast<int>(random() % factors[f].levels.size());
      } while (!possible(cell_of(factors, row).config));
      Cell cell = cell_of(factors, row);
      cell.config.cull_planes = planes;
      if (cell.config.engine.kind == EngineKind::kCycle)
        cell.threads = 1;  // threads: tests/ringbus/identity/identity_test.cpp
      const Outcome outcome = run_cell(scene, cell);
      EXPECT_EQ(outcome.fault, "") << "CAROUSEL_SEED=" << run_seed() << " " << text(planes) << ": " << cell.text();
      culled += outcome.sum.tests.culled;
      for (const CullLevel& level : outcome.sum.culls.above) transforms_spared += level.transforms;
      const CullLevel all_depths = outcome.sum.culls.sum();
      EXPECT_EQ(all_depths.culled(), outcome.sum.tests.culled) << text(planes) << ": " << cell.text();
      EXPECT_EQ(all_depths.plane_tests, outcome.sum.tests.plane) << text(planes) << ": " << cell.text();
    }
  }
  EXPECT_GT(culled, 1000u);
  EXPECT_GT(transforms_spared, 100u);
}

TEST(CullPlanesIdentity, TracerGivesOneDigest) {
  std::uint64_t culled = 0;
  for (TestScene& scene : plane_scenes())
    for (const CullPlanesConfig& planes : all_planes()) {
      ScatterWorkload workload = scene.workload();
      const accel::ReferenceRun run = accel::run_reference(scene.accel(BvhConfig{}, planes), workload);
      EXPECT_EQ(workload.digest().hex(), scene.digest().hex()) << text(planes);
      culled += run.tests.culled;
    }
  EXPECT_GT(culled, 1000u);
}
TEST(CullPlanesIdentity, NativeRingGivesTheTracersDigest) {
  expect_one_plane_digest(machine_factors(), 3);
}
TEST(CullPlanesIdentity, CycleEngineGivesTheTracersDigest) {
  expect_one_plane_digest(cycle_factors(), 4);
}

}  // namespace
}  // namespace carousel::ringbus
