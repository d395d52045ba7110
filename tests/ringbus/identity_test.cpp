// No arrangement of threads, queues and policies may change a bit: every cell of the covering array and every
// random one has the reference tracer's digest.
#include <iostream>
#include <set>

#include <gtest/gtest.h>

#include "tests/ringbus/covering_array.h"
#include "tests/ringbus/factors.h"

namespace carousel::ringbus {
namespace {

Cell cell_of(const std::vector<Factor>& factors, const std::vector<int>& row) {
  Cell cell;
  for (std::size_t f = 0; f < factors.size(); ++f) factors[f].levels[static_cast<std::size_t>(row[f])](cell);
  return cell;
}

std::vector<int> level_counts(const std::vector<Factor>& factors) {
  std::vector<int> levels;
  for (const Factor& f : factors) levels.push_back(static_cast<int>(f.levels.size()));
  return levels;
}

std::vector<std::vector<int>> pairwise(const std::vector<Factor>& factors, std::uint32_t seed) {
  return covering_array(
      level_counts(factors), [&](const std::vector<int>& row) { return possible(cell_of(factors, row).config); }, seed);
}

void expect_one_digest(TestScene& scene, std::uint32_t number, int random_cells) {
  ASSERT_GT(scene.rays(), 1000u);   // most rays hit and send on others
  SCOPED_TRACE(fmt::format("CAROUSEL_SEED={}", run_seed()));   // rays and arrays follow from it
  const std::uint32_t array_seed = 4 * (run_seed() - 1) + number;
  const std::vector<Factor> factors = machine_factors();
  std::vector<std::vector<int>> rows = pairwise(factors, array_seed);
#ifdef __SANITIZE_THREAD__
  rows.resize(rows.size() / 6);
#endif
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Cell cell = cell_of(factors, rows[i]);
    EXPECT_EQ(run_cell(scene, cell).fault, "") << "array seed " << array_seed << " row " << i << ": " << cell.text();
  }
  const auto count = static_cast<std::uint32_t>(cell_count(random_cells));
  for (std::uint32_t seed = run_seed(); seed < run_seed() + count; ++seed) {
    std::mt19937 random(seed * 7919 + array_seed);
    std::vector<int> row(factors.size());
    do {
      for (std::size_t f = 0; f < row.size(); ++f) row[f] = static_cast<int>(random() % factors[f].levels.size());
    } while (!possible(cell_of(factors, row).config));
    const Cell cell = cell_of(factors, row);
    EXPECT_EQ(run_cell(scene, cell).fault, "") << "seed " << seed << ": " << cell.text();
  }
  std::cout << rows.size() + count << " machines, " << scene.rays() << " rays each\n";
}

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
  expect_one_digest(scene, 1, 50);
}

TEST(Identity, Terrain) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 400, 3);
  expect_one_digest(scene, 2, 50);
}

TEST(Identity, Sliver) {
  TestScene scene(builtin_scene(BuiltinScene::kSliver, 1000, 0), 1200, 3);
  expect_one_digest(scene, 3, 50);
}

// Rotated, mirrored and unequally scaled instances, seen from a hundred radii away.
TEST(Identity, ThousandsOfInstancesFromFarAway) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 3000), 800, 3, 100.0f);
  expect_one_digest(scene, 4, 50);
}

}  // namespace
}  // namespace carousel::ringbus
