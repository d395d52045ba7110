#pragma once

#include <cstdint>

#include "report/run/report.h"

namespace carousel::app {

/// The machine that runs this program; a value that cannot be determined is empty or 0.
report::Machine machine_info();

/// Memory this process may use: the machine's, or the limit of its control group or of its data if that is less.
std::uint64_t usable_memory_bytes();

}  // namespace carousel::app
