#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "app/sweep/plan/axis.h"

namespace carousel::app {

/// The values of all varied keys at one point.
using Choice = std::vector<KeyValue>;

/// Every combination of levels; the last axis changes fastest.
std::vector<Choice> grid(const std::vector<Axis>& axes);

/// A Latin hypercube: `points` choices that divide each axis into as many strata of equal size and take one value from
/// each. Depends on the seed alone. Source: M. D. McKay, R. J. Beckman, W. J. Conover, "A comparison of three methods
/// for selecting values of input variables in the analysis of output from a computer code", Technometrics 21 (1979).
std::vector<Choice> latin_hypercube(const std::vector<Axis>& axes, std::size_t points, std::uint64_t seed);

}  // namespace carousel::app
