#pragma once

#include <nlohmann/json.hpp>

#include "report/report.h"

namespace carousel::report {

/// report.json (DESIGN.md section 9). Keys stand in the order of the description.
nlohmann::ordered_json report_json(const Report& report);

/// JSON Schema (draft 2020-12) of it: types, units, meanings.
nlohmann::ordered_json report_schema();

}  // namespace carousel::report
