#pragma once

#include <vector>

#include "accel/structure/accel.h"
#include "report/sections/structure/structure.h"
#include "ringbus/cycle/shapes/shape_memory.h"
#include "ringbus/results/cycle_result.h"

namespace carousel::app {

/// The levels of a structure that is here as a whole, with the bytes that each has in the machine's memory.
std::vector<report::StructureLevel> structure_levels(const accel::Accel& accel,
                                                     const ringbus::cycle::ShapeMemory& memory);

/// The depths of all levels of a structure that is here as a whole. `cycle`: null for a run without virtual time.
std::vector<report::StructureDepth> structure_depths(const accel::Accel& accel,
                                                     const ringbus::cycle::ShapeMemory& memory,
                                                     const ringbus::cycle::CycleResult* cycle);

/// Adds up the depths of each level into its row.
void add_depths(const std::vector<report::StructureDepth>& depths, std::vector<report::StructureLevel>& levels);

}  // namespace carousel::app
