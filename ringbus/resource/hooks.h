#pragma once

#include "accel/structure/node.h"
#include "accel/traverse/kernels.h"
#include "core/statistics/intersection_counts.h"
#include "ringbus/packets/events.h"
#include "ringbus/resource/transform_account.h"

namespace carousel::ringbus {

/// Takes rays through a whole subtree, for an engine that keeps an account of it. Without one the kernels do.
class SubtreeTracer {
 public:
  virtual ~SubtreeTracer() = default;
  virtual void trace(accel::NodeKey from, const accel::RayMembers& members, IntersectionCounts& counts) = 0;
};

/// An engine's own parts that a resource calls. Nothing is owned, and each pointer may be null.
struct ResourceHooks {
  EventSink* events = nullptr;              ///< is told of everything that happens
  SubtreeTracer* subtree_tracer = nullptr;  ///< traces treelets
  TransformAccount* transforms = nullptr;   ///< counts transforms instead of the kernels
  bool hold_any_hit_rays = false;  ///< a ray that makes an any-hit call waits for release() before it may complete
};

}  // namespace carousel::ringbus
