#pragma once

#include <string>

#include "report/sections/ray_life.h"

namespace carousel::report {

/// The life of a ray as `carousel follow` prints it.
std::string ray_life_table(const RayLife& life);

}  // namespace carousel::report
