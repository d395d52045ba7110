#include "app/sweep/plan/design.h"

#include <algorithm>
#include <numeric>

#include "core/numeric/rng.h"

namespace carousel::app {

namespace {

void append(Choice& choice, const Axis& axis, const std::vector<std::string>& level) {
  for (std::size_t i = 0; i < axis.keys.size(); ++i) choice.emplace_back(axis.keys[i], level[i]);
}

/// The strata of an axis in random order (Fisher and Yates), and the place within each.
struct Shuffled {
  std::vector<std::uint32_t> stratum;
  std::vector<double> part;
};

Shuffled shuffle(std::size_t points, std::uint64_t seed, std::uint32_t axis) {
  Shuffled out{std::vector<std::uint32_t>(points), {}};
  std::iota(out.stratum.begin(), out.stratum.end(), 0u);
  for (std::size_t i = points; i-- > 0;) {
    const PhiloxCounter words = random_block({seed, axis, static_cast<std::uint32_t>(i), 0}, 0);
    const std::uint64_t below = (std::uint64_t{words[0]} * (i + 1)) >> 32;
    std::swap(out.stratum[i], out.stratum[below]);
    out.part.push_back((words[1] >> 8) * 0x1p-24);
  }
  return out;
}

}  // namespace

std::vector<Choice> grid(const std::vector<Axis>& axes) {
  std::vector<Choice> out(1);
  for (const Axis& axis : axes) {
    std::vector<Choice> longer;
    for (const Choice& choice : out)
      for (const auto& level : axis.levels) append(longer.emplace_back(choice), axis, level);
    out = std::move(longer);
  }
  return out;
}

std::vector<Choice> latin_hypercube(const std::vector<Axis>& axes, std::size_t points, std::uint64_t seed) {
  std::vector<Choice> out(points);
  for (std::uint32_t a = 0; a < axes.size(); ++a) {
    const Shuffled shuffled = shuffle(points, seed, a);
    for (std::size_t i = 0; i < points; ++i) {
      const double part = (shuffled.stratum[i] + shuffled.part[i]) / static_cast<double>(points);
      if (axes[a].span) {
        out[i].emplace_back(axes[a].keys[0], axes[a].span->at(part));
      } else {
        const auto level = static_cast<std::size_t>(part * static_cast<double>(axes[a].levels.size()));
        append(out[i], axes[a], axes[a].levels[std::min(level, axes[a].levels.size() - 1)]);
      }
    }
  }
  return out;
}

}  // namespace carousel::app
