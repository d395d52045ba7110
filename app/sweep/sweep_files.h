#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "app/sweep/analysis.h"
#include "app/sweep/results.h"

namespace carousel::app {

/// sweep.csv: a row a point, as RFC 4180: point, status, the varied keys, the results, error.
std::string sweep_csv(const SweepRows& rows);

/// sweep.json: the same, with the Pareto front, if one was asked for, and the main effects on all numeric results.
nlohmann::ordered_json sweep_json(const SweepRows& rows, const std::vector<Goal>& goals, const std::string& config);

/// One row of sweep.json.
nlohmann::ordered_json row_json(const SweepRows& rows, const SweepRow& row);

/// The table for a terminal of so many columns: the best points, the Pareto front, the main effects on one result.
std::string sweep_table(const SweepRows& rows, const std::vector<Goal>& goals, std::size_t width);

}  // namespace carousel::app
