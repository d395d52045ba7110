// At every level of the triangle and the box test the ring gives the reference tracer's digest of that level, on
// either engine.
#include <set>

#include <gtest/gtest.h>

#include "tests/accel/traverse/levels.h"
#include "tests/ringbus/identity/factors.h"
#include "tests/ringbus/identity/identity_cells.h"

namespace carousel::ringbus {
namespace {

void expect_one_digest_a_level(const std::vector<Factor>& factors, std::uint32_t number) {
  std::set<std::string> digests;
  for (const AccuracyConfig& accuracy : accel::triangle_and_box_levels()) {
    SCOPED_TRACE(accel::text(accuracy));
    TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 300), 150, 3, 0.5f, accuracy);
    ASSERT_GT(scene.rays(), 200u);
    digests.insert(scene.digest().hex());
    const int cells = cell_count(6);
    for (int i = 0; i < cells; ++i) {
      std::mt19937 random(static_cast<std::uint32_t>(i) + 1000 * number + 7919 * run_seed());
      std::vector<int> row(factors.size());
      do {
        for (std::size_t f = 0; f < row.size(); ++f) row[f] = static_cast<int>(random() % factors[f].levels.size());
      } while (!possible(cell_of(factors, row).config));
      Cell cell = cell_of(factors, row);
      cell.config.accuracy = accuracy;
      EXPECT_EQ(run_cell(scene, cell).fault, "")
          << "CAROUSEL_SEED=" << run_seed() << " cell " << i << ": " << cell.text();
    }
  }
  EXPECT_GE(digests.size(), 4u);  // levels are seen in the hits, or this shows nothing
}

TEST(LevelsIdentity, NativeRingGivesTheTracersDigest) {
  expect_one_digest_a_level(machine_factors(), 1);
}
TEST(LevelsIdentity, CycleEngineGivesTheTracersDigest) {
  expect_one_digest_a_level(cycle_factors(), 2);
}

}  // namespace
}  // namespace carousel::ringbus
