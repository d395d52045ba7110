#pragma once

#include <string>

#include "report/sections/bottleneck.h"

namespace carousel::report {

/// The lines of a run's table about what limits the machine, each with its end.
std::string verdict_table(const Bottleneck& found);

}  // namespace carousel::report
