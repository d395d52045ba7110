#include "tests/ringbus/identity/covering_array.h"

#include <algorithm>
#include <numeric>

namespace carousel::ringbus {

namespace {

/// Which pairs of levels still stand in no row.
class OpenPairs {
 public:
  explicit OpenPairs(const std::vector<Factor>& factors) {
    for (const Factor& f : factors) {
      begin_.push_back(levels_);
      levels_ += f.values.size();
    }
    open_.assign(levels_ * levels_, 0);
  }

  void open(const LevelPair& p) { at(p.f, p.a, p.g, p.b) = at(p.g, p.b, p.f, p.a) = 1; }
  bool is_open(const LevelPair& p) const { return open_[index(p.f, p.a, p.g, p.b)] != 0; }
  /// Open pairs of level a of f with the row's other levels.
  int gain(std::size_t f, int a, const Row& row) const {
    int sum = 0;
    for (std::size_t g = 0; g < row.size(); ++g)
      if (g != f && row[g] != kAbsent) sum += open_[index(f, a, g, row[g])];
    return sum;
  }
  int gain(const Row& row) const {
    int sum = 0;
    for (std::size_t f = 0; f < row.size(); ++f)
      if (row[f] != kAbsent) sum += gain(f, row[f], row);
    return sum / 2;
  }
  void close(const Row& row) {
    for (std::size_t f = 0; f < row.size(); ++f)
      for (std::size_t g = 0; g < row.size(); ++g)
        if (f != g && row[f] != kAbsent && row[g] != kAbsent) at(f, row[f], g, row[g]) = 0;
  }

 private:
  std::size_t index(std::size_t f, int a, std::size_t g, int b) const {
    return (begin_[f] + static_cast<std::size_t>(a)) * levels_ + begin_[g] + static_cast<std::size_t>(b);
  }
  char& at(std::size_t f, int a, std::size_t g, int b) { return open_[index(f, a, g, b)]; }

  std::vector<std::size_t> begin_;
  std::size_t levels_ = 0;
  std::vector<char> open_;
};

/// Factor by factor, in random order, takes the level that covers most open pairs and is not refused.
void improve(Row& row, MachineSpace& space, const Domains& domains, const OpenPairs& open, std::mt19937& random) {
  std::vector<std::size_t> order(row.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), random);
  for (const std::size_t f : order) {
    if (row[f] == kAbsent || space.is_switch(f)) continue;
    int best = row[f], most = open.gain(f, row[f], row);
    for (const int level : domains[f]) {
      row[f] = level;
      const int gain = open.gain(f, level, row);
      if (gain > most && !space.known_refused(row)) most = gain, best = level;
    }
    row[f] = best;
  }
}

}  // namespace

CoveringArray covering_array(MachineSpace& space, std::uint32_t seed) {
  CoveringArray out;
  std::mt19937 random(seed);
  OpenPairs open(space.factors());
  std::vector<LevelPair> pairs;
  const std::size_t n = space.factors().size();
  for (std::size_t f = 0; f < n; ++f)
    for (std::size_t g = f + 1; g < n; ++g)
      for (int a = 0; a < static_cast<int>(space.factors()[f].values.size()); ++a)
        for (int b = 0; b < static_cast<int>(space.factors()[g].values.size()); ++b) {
          if (space.domains_of_pair(f, a, g, b).empty()) continue;
          pairs.push_back({f, g, a, b});
          open.open(pairs.back());
        }
  out.pairs = pairs.size();
  std::shuffle(pairs.begin(), pairs.end(), random);
  constexpr int kCandidates = 6;
  for (const LevelPair& pair : pairs) {
    if (!open.is_open(pair)) continue;
    const Domains domains = space.domains_of_pair(pair.f, pair.a, pair.g, pair.b);
    Row best;
    int most = 0;
    for (int candidate = 0; candidate < kCandidates; ++candidate) {
      std::optional<Row> row = space.draw(random, domains);
      if (!row) break;
      const Row drawn = *row;
      improve(*row, space, domains, open, random);
      improve(*row, space, domains, open, random);
      if (!space.accepts(*row)) row = drawn;
      if (const int gain = open.gain(*row); gain > most) most = gain, best = *row;
    }
    if (best.empty()) {
      out.infeasible.push_back(pair);
      continue;
    }
    open.close(best);
    out.rows.push_back(std::move(best));
  }
  for (const LevelPair& pair : pairs) out.covered += !open.is_open(pair);
  const std::size_t refused = out.infeasible.size();
  std::erase_if(out.infeasible, [&](const LevelPair& p) {
    return space.is_never_accepted(p.f, p.a) || space.is_never_accepted(p.g, p.b);
  });
  out.pairs -= refused - out.infeasible.size();
  return out;
}

}  // namespace carousel::ringbus
