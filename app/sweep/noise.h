#pragma once

#include <vector>

#include "app/sweep/analysis.h"

namespace carousel::app {

/// By row: true if the result of `goal` differs from the best row's by no more than another seed of the picture makes
/// it differ (95 %), so that the order of both says nothing. False for the best row, and where the noise is not known.
///
/// If `image.seed` is among the keys that vary, as with `--repeat`, the noise of any result is that of the rows that
/// are equal but for it: their deviations, as parts of the mean of each group, are taken together, and the difference
/// of two has Student's distribution. Else it is the noise of the cycles that the reports of both rows have, or one of
/// them, for results that follow from the cycles.
std::vector<bool> ties_with_best(const SweepRows& rows, const Goal& goal);

}  // namespace carousel::app
