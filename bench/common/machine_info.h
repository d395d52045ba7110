#pragma once

#include "bench/common/results.h"

namespace carousel::bench {

/// Machine, program and date of a measurement. A value that cannot be determined is "unknown".
MachineInfo machine_info();

}  // namespace carousel::bench
