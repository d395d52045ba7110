#pragma once

#include <vector>

#include "accel/structure/accel.h"
#include "core/system/executor.h"

namespace carousel::accel {

/// One a node: around the middle of a child's box, as small as goes with the boxes of all primitives below it (of all
/// instances, above these).
std::vector<NodeSpheres> bounding_spheres(const Accel& accel, Executor& executor);

}  // namespace carousel::accel
