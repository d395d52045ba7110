#pragma once

#include "bench/common/results.h"

namespace carousel::bench {

/// This machine, this program, now. What cannot be found out is "unknown".
MachineInfo machine_info();

}  // namespace carousel::bench
