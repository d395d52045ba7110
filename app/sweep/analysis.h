#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "app/sweep/results.h"

namespace carousel::app {

/// A result to be made small or large.
struct Goal {
  std::size_t column = 0;
  bool maximise = false;
};

/// The goals of `--pareto a,b`; `max:` or `min:` before a name says what is better. Throws ConfigError.
std::vector<Goal> parse_goals(const SweepRows& rows, const std::string& text);

/// The rows that no other row betters in one result without being worse in another, in the order of the first one.
std::vector<std::size_t> pareto_front(const SweepRows& rows, const std::vector<Goal>& goals);

/// The effect of one value of a key on a result: by how much the mean of its points differs from the mean of all, the
/// other keys accounted for.
struct LevelEffect {
  std::string level;
  std::size_t points = 0;
  double effect = 0;
  std::optional<double> half_width;  ///< half the interval of confidence (95 %); absent if nothing is left to judge by
};

struct MainEffect {
  std::string key, result;
  double mean = 0;  ///< mean of the result
  std::vector<LevelEffect> levels;
};

/// The main effects of all keys on a numeric result, by least squares of an additive model (G. E. P. Box, J. S. Hunter,
/// W. G. Hunter, "Statistics for experimenters", 2005, chapter 5). The interval is that of Student's distribution with
/// the residuals' degrees of freedom; it is exact in a full grid whose residuals are normal, and covers neither
/// interactions of keys nor other seeds. A key with more than eight numeric values is divided into four parts with
/// equally many points. Keys with one value have no effect and are left out.
std::vector<MainEffect> main_effects(const SweepRows& rows, std::size_t column);

}  // namespace carousel::app
