#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "report/html/page.h"

namespace carousel::report::html {

/// The costs of each pixel's rays.
struct HeatMap {
  Picture picture;     ///< their cycles, few dark; shown without scripts
  std::string rows{};  ///< heat.csv, as `carousel run --heat` writes it; empty: there is none
};

/// report.html of a run, from its report.json. Also for reports of older programs: sections whose numbers are missing
/// are left out. `versus`, if not null, is versus.json of the same machine (is_of_run()).
std::string run_page(const nlohmann::ordered_json& report, const Picture& picture, const HeatMap& heat = {},
                     const nlohmann::ordered_json* versus = nullptr);

/// True if a run of `versus` is that of `report`: its machine had the same hits, in as many cycles.
bool is_of_run(const nlohmann::ordered_json& versus, const nlohmann::ordered_json& report);

}  // namespace carousel::report::html
