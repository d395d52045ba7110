#pragma once

#include <vector>

#include "accel/structure/accel.h"
#include "core/system/executor.h"

namespace carousel::accel {

/// Fits the oriented boxes of every node, each with little surface around what stands below a child: triangles and
/// spheres, above the instances the boxes of instances. A leaf's box lies along an edge of one of its triangles and in
/// its plane, an inner child's as one of those below; or along the axes where no such box is smaller.
std::vector<NodeOrientedBoxes> bounding_oriented_boxes(const Accel& accel, Executor& executor);

}  // namespace carousel::accel
