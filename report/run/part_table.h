#pragma once

#include <string>

#include "core/config/parts.h"

namespace carousel::report {

/// A line for each part that declares itself and is built, with its counts.
std::string part_table(const PartCounts<Parts>& parts);

}  // namespace carousel::report
