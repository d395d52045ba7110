#pragma once

#include <string>

#include "report/accuracy/accuracy.h"

namespace carousel::report {

/// The names of a row's levels: triangle + box + transform.
std::string levels_text(const AccuracyRow& row);
/// The median cost by a clock, with its unit. Precondition: it was measured.
std::string cost_text(const AccuracyRow& row, Clock clock);
/// A price in percent.
std::string over_text(const CostRatio& over);
/// Its interval, in parentheses behind a space; empty where it has no width.
std::string interval_text(const CostRatio& over);
/// The errors of a row, as the end of a sentence whose subject is the row.
std::string errors_text(const AccuracyRow& row);

}  // namespace carousel::report
