#pragma once

#include "report/run/report.h"

namespace carousel::app {

/// Version and commit of this program, for its reports.
report::Program program_info();

}  // namespace carousel::app
