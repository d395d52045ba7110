#pragma once

#include <optional>
#include <vector>

#include "core/config/config.h"
#include "report/sections/drawing.h"

namespace carousel::app {

/// The nodes of a network that is drawn, by their numbers in the lists of the report; absent for other shapes.
std::optional<std::vector<report::DrawnNode>> drawing(const Config& config);

}  // namespace carousel::app
