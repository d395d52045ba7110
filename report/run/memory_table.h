#pragma once

#include <string>

#include "report/run/report.h"

namespace carousel::report {

/// Some lines for a person about the memory alone; `report` has the section.
std::string memory_table(const Report& report);

}  // namespace carousel::report
