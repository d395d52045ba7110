#pragma once

#include <vector>

#include "core/config/load/network_rules.h"
#include "core/config/tree/positions.h"
#include "core/system/error.h"

namespace carousel::config {

/// Appends what is wrong with primitives, their programs and the objects of the scene. A fault of an instruction stands
/// at its word. A unit runs a program as a whole: units side by side and lanes would divide it, and are refused.
void check_programs(const Config& config, const KeyPositions& positions, std::vector<ConfigIssue>& issues);

}  // namespace carousel::config
