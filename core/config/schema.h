#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace carousel {

/// JSON Schema (draft 2020-12) of a configuration: types, ranges, names, defaults, units, meanings.
/// Cross-field rules (core/config/validate.h) are not in it.
nlohmann::ordered_json config_schema();

/// Every key path with its kind, default, unit and meaning, as a Markdown table.
std::string config_markdown();

namespace config {

/// Every key path, sections included, in the order of the schema.
const std::vector<std::string>& config_key_paths();

/// The shortest key path whose last name is `key`.
std::optional<std::string> config_path_ending_in(std::string_view key);

}  // namespace config
}  // namespace carousel
