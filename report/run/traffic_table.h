#pragma once

#include <string>

#include "report/run/report.h"

namespace carousel::report {

/// Some lines for a person about a run of synthetic traffic; `report` has the section.
std::string traffic_table(const Report& report);

}  // namespace carousel::report
