#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/fields/engine.h"
#include "report/sections/program.h"

namespace carousel::app {

/// Opens plugins that an option `--plugin` names, and returns their files, by which their names count. Throws a
/// ConfigError.
std::vector<std::string> open_plugins(const std::vector<std::string>& names);

/// The files of the plugins of a configuration in a folder, which are open, as open_plugins() returns them.
std::vector<std::string> plugins_of(const EngineConfig& engine, const std::filesystem::path& config_folder);

/// What the report says of them; absent if there are none.
std::optional<std::vector<report::Plugin>> plugins_section(const EngineConfig& engine,
                                                           const std::filesystem::path& config_folder);

}  // namespace carousel::app
