#pragma once

#include <nlohmann/json.hpp>

namespace carousel::report {

/// JSON Schema of accuracy.json.
nlohmann::ordered_json accuracy_schema();

}  // namespace carousel::report
