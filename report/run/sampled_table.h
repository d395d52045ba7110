#pragma once

#include <string>

#include "report/sections/sampled.h"

namespace carousel::report {

/// The lines of a run's table about a sampled frame: each estimate with its interval, and after an audit the value of
/// the whole frame and the error.
std::string sampled_table(const Sampled& sampled);

}  // namespace carousel::report
