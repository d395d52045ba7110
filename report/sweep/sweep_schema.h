#pragma once

#include <nlohmann/json.hpp>

namespace carousel::report {

/// JSON Schema of sweep.json.
nlohmann::ordered_json sweep_schema();

/// JSON Schema of a finished point, points/DIGEST.json. `run` is that of report.json.
nlohmann::ordered_json point_schema(nlohmann::ordered_json run);

}  // namespace carousel::report
