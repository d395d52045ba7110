#pragma once

#include <string>

#include "report/run/report.h"

namespace carousel::report {

/// The report as text for a terminal, with a newline at the end.
std::string report_table(const Report& report);

}  // namespace carousel::report
