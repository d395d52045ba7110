#pragma once

#include <string>

#include "report/sections/rays/heat.h"
#include "report/sections/rays/ray_time.h"

namespace carousel::report {

/// The line of where the rays' cycles go: stages with less than one percent are left out.
std::string ray_time_table(const RayTime& time);
/// The line of the slowest pixels; nothing if there are none.
std::string heat_table(const Heat& heat);

}  // namespace carousel::report
