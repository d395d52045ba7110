#pragma once

#include "accel/structure/accel.h"
#include "report/sections/structure/levels.h"

namespace carousel::app {

/// Of a structure with groups.
report::Levels levels_section(const accel::Accel& accel);

}  // namespace carousel::app
