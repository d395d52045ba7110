#pragma once

#include <vector>

#include "accel/structure/accel.h"
#include "report/sections/structure/structure.h"
#include "ringbus/cycle/shapes/shape_memory.h"

namespace carousel::app {

/// The levels of a structure that is here as a whole, with the bytes that each has in the machine's memory.
std::vector<report::StructureLevel> structure_levels(const accel::Accel& accel,
                                                     const ringbus::cycle::ShapeMemory& memory);

}  // namespace carousel::app
