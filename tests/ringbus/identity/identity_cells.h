#pragma once

#include <iostream>

#include <gtest/gtest.h>

#include "tests/ringbus/identity/covering_array.h"
#include "tests/ringbus/identity/factors.h"

namespace carousel::ringbus {

inline Cell cell_of(const std::vector<Factor>& factors, const std::vector<int>& row) {
  Cell cell;
  for (std::size_t f = 0; f < factors.size(); ++f) factors[f].levels[static_cast<std::size_t>(row[f])](cell);
  return cell;
}

inline std::vector<int> level_counts(const std::vector<Factor>& factors) {
  std::vector<int> levels;
  for (const Factor& f : factors) levels.push_back(static_cast<int>(f.levels.size()));
  return levels;
}

inline std::vector<std::vector<int>> pairwise(const std::vector<Factor>& factors, std::uint32_t seed) {
  return covering_array(
      level_counts(factors), [&](const std::vector<int>& row) { return possible(cell_of(factors, row).config); }, seed);
}

/// Every cell of the factors' covering array, and so many random ones, has the scene's digest.
inline void expect_one_digest(TestScene& scene, const std::vector<Factor>& factors, std::uint32_t number,
                              int random_cells) {
  ASSERT_GT(scene.rays(), 1000u);                             // most rays hit and send on others
  SCOPED_TRACE(fmt::format("CAROUSEL_SEED={}", run_seed()));  // rays and arrays follow from it
  const std::uint32_t array_seed = 32 * (run_seed() - 1) + number;
  std::vector<std::vector<int>> rows = pairwise(factors, array_seed);
#ifdef __SANITIZE_THREAD__
  rows.resize(rows.size() / 16);  // the checked build runs all of them
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

}  // namespace carousel::ringbus
