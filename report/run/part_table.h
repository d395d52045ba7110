#pragma once

#include <string>
#include <vector>

#include "core/config/parts.h"
#include "report/sections/resource.h"

namespace carousel::report {

/// A line for each part that declares itself and is built, with its counts.
std::string part_table(const PartCounts<Parts>& parts);

/// A line for the lanes of all warps together; nothing where there are none.
std::string warp_table(const std::vector<Resource>& resources);

}  // namespace carousel::report
