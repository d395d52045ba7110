#pragma once

#include <string>

#include "report/stress/stress.h"

namespace carousel::report {

/// For people: a block a pattern, a line a queue.
std::string stress_table(const Stress& stress);

}  // namespace carousel::report
