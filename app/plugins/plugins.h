#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/sections/program.h"

namespace carousel::app {

/// Opens plugins that an option `--plugin` names, and returns their files, by which their names count. Throws a
/// ConfigError.
std::vector<std::string> open_plugins(const std::vector<std::string>& names);

/// The section of the report about the plugins in these files, which are open; absent if there are none.
std::optional<std::vector<report::Plugin>> plugins_section(const std::vector<std::string>& files);

}  // namespace carousel::app
