#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/config/config.h"

namespace carousel {

/// The resolved configuration: every key with its value; keys that are optional and absent are left out.
/// Reads back to the same Config.
nlohmann::ordered_json config_json(const Config& config);

/// The resolved configuration as YAML text: every key with its value, without optional keys that are absent.
std::string resolved_yaml(const Config& config);

/// A value as YAML in one line.
std::string yaml_line(const nlohmann::ordered_json& value);

/// The double whose shortest decimal form is that of `value`: how floats are put into JSON.
double shortest(float value);

}  // namespace carousel
