#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/config/config.h"
#include "ringbus/verdict/pilot_runs.h"

namespace carousel::ringbus {

// What a search may cost, as a part of the run's rays. A pilot's ray takes about as long as one of the run.
inline constexpr double kScreening = 0.4;   ///< that the first pilot is to take
inline constexpr double kWanted = 0.75;     ///< that all pilots are to take
inline constexpr double kAtMost = 1.1;      ///< beyond which no simulation begins
inline constexpr double kWithFrame = 1.55;  ///< the same, where the last one is the whole frame

struct SearchBudget {
  std::uint64_t paths = 0, rays = 0;  ///< of the run

  /// Rays of each of so many simulations that take this part of the run's together.
  std::uint64_t share(double part, std::size_t simulations) const {
    return static_cast<std::uint64_t>(std::max(0.0, part) * static_cast<double>(rays) /
                                      static_cast<double>(simulations));
  }
  /// The part of the run's rays that so many simulations of these paths take.
  double of(std::uint64_t pilot, std::size_t simulations) const {
    return static_cast<double>(simulations * pilot) / static_cast<double>(paths);
  }
  /// What is left of this part of the run's rays when so many have been simulated.
  double left(double part, std::uint64_t simulated) const {
    return part - static_cast<double>(simulated) / static_cast<double>(rays);
  }
};

/// Paths of a pilot twice as large for one to two of these classes, of which the others are left out, or none if there
/// are none; 0 if `left` of the run's rays does not suffice.
inline std::uint64_t doubled(const SearchBudget& budget, std::uint64_t pilot, double left,
                             std::vector<std::size_t>& classes) {
  const std::uint64_t twice = std::min(budget.paths, 2 * pilot);
  for (classes.resize(std::min<std::size_t>(classes.size(), 2));; classes.pop_back()) {
    if (budget.of(twice, classes.size() + 1) <= left) return twice;
    if (classes.size() <= 1) return 0;
  }
}

/// Paths of a search's first pilot, which so many machines simulate: the least that will do where more would take too
/// much.
inline std::uint64_t first_paths(const Config& config, std::uint64_t paths, const SearchBudget& budget,
                                 std::size_t machines) {
  constexpr double kMuch = 0.6;
  const std::uint64_t wanted = budget.share(kScreening, machines),
                      full = pilot_paths(config, paths, budget.rays, wanted, PilotSize::kFull);
  return budget.of(full, machines) <= kMuch ? full : pilot_paths(config, paths, budget.rays, wanted, PilotSize::kLeast);
}

}  // namespace carousel::ringbus
