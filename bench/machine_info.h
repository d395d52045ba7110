#pragma once

#include "bench/results.h"

namespace carousel::bench {

/// This machine, this program, now. What cannot be found out is "unknown".
MachineInfo machine_info();

}  // namespace carousel::bench
