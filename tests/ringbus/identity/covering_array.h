#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <vector>

namespace carousel::ringbus {

/// Rows of levels, one a factor, such that every pair of levels of two factors that any allowed row can hold
/// stands in some row: D. M. Cohen et al., "The AETG system: an approach to testing based on combinatorial
/// design", 1997, with a fixed seed. `allowed` judges whole rows.
inline std::vector<std::vector<int>> covering_array(const std::vector<int>& levels,
                                                    const std::function<bool(const std::vector<int>&)>& allowed,
                                                    std::uint32_t seed) {
  struct Pair {
    std::size_t f, g;
    int a, b;
  };
  const std::size_t n = levels.size();
  std::vector<std::vector<std::vector<char>>> open(n * n);  // [f * n + g][level of f][level of g], f < g
  std::vector<Pair> pairs;
  for (std::size_t f = 0; f < n; ++f) {
    for (std::size_t g = f + 1; g < n; ++g) {
      open[f * n + g].assign(static_cast<std::size_t>(levels[f]),
                             std::vector<char>(static_cast<std::size_t>(levels[g]), 1));
      for (int a = 0; a < levels[f]; ++a)
        for (int b = 0; b < levels[g]; ++b) pairs.push_back({f, g, a, b});
    }
  }
  const auto is_open = [&](std::size_t f, int a, std::size_t g, int b) -> char& {
    return f < g ? open[f * n + g][static_cast<std::size_t>(a)][static_cast<std::size_t>(b)]
                 : open[g * n + f][static_cast<std::size_t>(b)][static_cast<std::size_t>(a)];
  };
  std::minstd_rand random(seed);
  const auto random_row = [&] {
    std::vector<int> row(n);
    for (std::size_t f = 0; f < n; ++f) row[f] = static_cast<int>(random() % static_cast<std::uint32_t>(levels[f]));
    return row;
  };
  std::vector<std::vector<int>> rows;
  for (const Pair& pair : pairs) {
    if (!is_open(pair.f, pair.a, pair.g, pair.b)) continue;
    // An allowed row with this pair; a pair no draw can complete is taken to be impossible.
    std::vector<int> row;
    bool found = false;
    for (int attempt = 0; attempt < 400 && !found; ++attempt) {
      row = random_row();
      row[pair.f] = pair.a;
      row[pair.g] = pair.b;
      found = allowed(row);
    }
    if (!found) continue;
    // Then, factor by factor, the level that covers most open pairs and keeps the row allowed.
    for (std::size_t f = 0; f < n; ++f) {
      if (f == pair.f || f == pair.g) continue;
      int best = row[f], most = -1;
      const int kept = row[f];
      for (int a = 0; a < levels[f]; ++a) {
        row[f] = a;
        if (!allowed(row)) continue;
        int gain = 0;
        for (std::size_t g = 0; g < n; ++g) gain += g != f && is_open(f, a, g, row[g]);
        if (gain > most || (gain == most && a == kept)) most = gain, best = a;
      }
      row[f] = best;
    }
    for (std::size_t f = 0; f < n; ++f)
      for (std::size_t g = f + 1; g < n; ++g) is_open(f, row[f], g, row[g]) = 0;
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace carousel::ringbus
