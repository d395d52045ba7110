#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace carousel {

/// JSON Schema (draft 2020-12) of a configuration: types, ranges, names, defaults, units, meanings. Where an engine
/// does not have a value, the keyword `engines` names those that do. Cross-field rules (core/config/load/validate.h)
/// are not in it.
nlohmann::ordered_json config_schema();

namespace config {

/// Calls visit(path, description) for every key of the schema, outer keys first. A list index is 0 in a path.
void walk_schema(const nlohmann::ordered_json& schema,
                 const std::function<void(const std::string&, const nlohmann::ordered_json&)>& visit);

/// Every key path, sections included, in the order of the schema.
const std::vector<std::string>& config_key_paths();

/// The names that the key at `path` takes; none if it is not an enumeration.
std::vector<std::string> enum_values(std::string_view path);

/// The shortest key path whose last name is `key`.
std::optional<std::string> config_path_ending_in(std::string_view key);

}  // namespace config
}  // namespace carousel
