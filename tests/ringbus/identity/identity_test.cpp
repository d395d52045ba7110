// No arrangement of threads, queues and policies may change a bit: every cell of the covering array and every
// random one has the reference tracer's digest.
#include <set>

#include <gtest/gtest.h>

#include "tests/ringbus/identity/identity_cells.h"

namespace carousel::ringbus {
namespace {

TEST(CoveringArray, HoldsEveryPossiblePair) {
  const std::vector<Factor> factors = machine_factors();
  const std::vector<int> levels = level_counts(factors);
  const auto rows = pairwise(factors, 1);
  EXPECT_LT(rows.size(), 80u);
  std::set<std::array<int, 4>> covered;
  for (const auto& row : rows) {
    EXPECT_TRUE(possible(cell_of(factors, row).config));
    for (int f = 0; f < static_cast<int>(row.size()); ++f)
      for (int g = f + 1; g < static_cast<int>(row.size()); ++g)
        covered.insert({f, g, row[static_cast<std::size_t>(f)], row[static_cast<std::size_t>(g)]});
  }
  std::size_t pairs = 0;
  for (std::size_t f = 0; f < levels.size(); ++f)
    for (std::size_t g = f + 1; g < levels.size(); ++g) pairs += static_cast<std::size_t>(levels[f] * levels[g]);
  // Three pairs cannot be: ordered and single, hash and reserve, bubble and depth 1.
  EXPECT_EQ(covered.size(), pairs - 3);
}

TEST(Identity, Cornell) {
  TestScene scene(builtin_scene(BuiltinScene::kCornell, 0, 0), 400, 3);
  expect_one_digest(scene, machine_factors(), 1, 50);
}

TEST(Identity, Terrain) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 400, 3);
  expect_one_digest(scene, machine_factors(), 2, 50);
}

TEST(Identity, Sliver) {
  TestScene scene(builtin_scene(BuiltinScene::kSliver, 1000, 0), 1200, 3);
  expect_one_digest(scene, machine_factors(), 3, 50);
}

// Rotated, mirrored and unequally scaled instances, seen from a hundred radii away.
TEST(Identity, ThousandsOfInstancesFromFarAway) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 3000), 800, 3, 100.0f);
  expect_one_digest(scene, machine_factors(), 4, 50);
}

}  // namespace
}  // namespace carousel::ringbus
