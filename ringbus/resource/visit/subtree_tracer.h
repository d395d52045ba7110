#pragma once

#include "accel/structure/node.h"
#include "accel/traverse/kernels.h"
#include "core/statistics/intersection_counts.h"

namespace carousel::ringbus {

/// Takes rays through a whole subtree, for an engine that keeps an account of it. Without one the kernels do.
class SubtreeTracer {
 public:
  virtual ~SubtreeTracer() = default;
  virtual void trace(accel::NodeKey from, const accel::RayMembers& members, IntersectionCounts& counts) = 0;
};

}  // namespace carousel::ringbus
