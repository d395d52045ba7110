#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "report/html/html.h"

namespace carousel::report::html {

// Drawings that the program writes itself, as SVG, so that a page can be read without scripts and on paper. Text stands
// beside them as HTML, which is as large on a telephone as on a wall.

/// A bar from nothing to the greatest value for each row that has a number in column `value`, `most` rows at most.
Html still_bars(const Table& table, std::size_t value, std::size_t most = 12);

/// A bar a row whose pieces are the row's shares of 1, with a legend of the columns that any row has. A column with the
/// title "nothing to do" is drawn pale.
Html still_stack(const Table& table, std::size_t most = 16);

/// A gain with its interval, a row each. Losses beyond the greatest gain are cut, with a mark, so that they squeeze
/// nothing.
struct StillGain {
  std::string name, text;
  double gain = 0, low = 0, high = 0;
};
Html still_gains(const std::vector<StillGain>& gains);

/// The machine of a report, coloured by the use of its parts, as one drawing.
Html still_machine(const nlohmann::ordered_json& report);

/// The greatest share of the cycles that a kind of unit of the resource was busy; without a clock, the rays that it
/// tested over those of the resource that tested most.
double use_of_resource(const nlohmann::ordered_json& resource, double cycles, double most_tested);

/// The use of every resource that has units, in their order: packet processes that serve others are the last ones.
std::vector<double> uses_of_resources(const nlohmann::ordered_json& report);

}  // namespace carousel::report::html
