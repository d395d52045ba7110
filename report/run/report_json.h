#pragma once

#include <cstddef>
#include <string>

#include <nlohmann/json.hpp>

#include "report/run/report.h"
#include "report/sections/ray_life.h"
#include "report/stress/stress.h"
#include "report/versus/versus.h"

namespace carousel::report {

/// report.json (docs/how-it-works/design.md, The report). Keys stand in the order of the description.
nlohmann::ordered_json report_json(const Report& report);
/// Its text, indented by two. A list of numbers stands on one line, as a row of a time series has many.
std::string json_text(const nlohmann::ordered_json& json);
/// Of `resources` resources those that have units, by the report's `config`: the first ones, as packet processes that
/// serve others are the last.
std::size_t resources_with_units(const nlohmann::ordered_json& config, std::size_t resources);

/// stress.json of `carousel stress`.
nlohmann::ordered_json stress_json(const Stress& stress);

/// versus.json of `carousel versus`.
nlohmann::ordered_json versus_json(const Versus& versus);

/// JSON Schema (draft 2020-12) of the report: types, units, meanings. The schemas of the other documents that are read
/// back (report/read/document.h) stand under $defs: sweep, point, accuracy, stress, ray_life.
nlohmann::ordered_json report_schema();

/// The document that `carousel follow --json` prints, under $defs.ray_life of the schema.
nlohmann::ordered_json ray_life_json(const RayLife& life);

}  // namespace carousel::report
