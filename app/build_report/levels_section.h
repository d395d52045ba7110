#pragma once

#include "accel/structure/accel.h"
#include "report/sections/structure/levels.h"

namespace carousel::app {

/// Makes the report's section on levels for a structure with groups.
report::Levels levels_section(const accel::Accel& accel);

}  // namespace carousel::app
