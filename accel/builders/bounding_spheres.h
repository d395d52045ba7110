#pragma once

#include <vector>

#include "accel/structure/accel.h"
#include "core/system/executor.h"

namespace carousel::accel {

/// Fits the spheres of every node. A child's sphere is centred in the middle of its box and is as small as the boxes of
/// all primitives below it allow; above the instances, the boxes of all instances.
std::vector<NodeSpheres> bounding_spheres(const Accel& accel, Executor& executor);

}  // namespace carousel::accel
