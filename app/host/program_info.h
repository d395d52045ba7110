#pragma once

#include "report/run/report.h"

namespace carousel::app {

/// This program, for its reports.
report::Program program_info();

}  // namespace carousel::app
