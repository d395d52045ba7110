#pragma once

#include <span>
#include <vector>

#include "accel/structure/node.h"
#include "accel/traverse/kernels.h"
#include "core/statistics/intersection_counts.h"
#include "ringbus/packets/packet.h"

namespace carousel::ringbus {

/// Takes rays through a part of the tree, for an engine that keeps an account of it. Without one the kernels do.
class SubtreeTracer {
 public:
  virtual ~SubtreeTracer() = default;
  virtual void trace(accel::NodeKey from, const accel::RayMembers& members, IntersectionCounts& counts) = 0;
  /// Takes each ray depth first through a treelet of the whole tree, from the root of it in `from`, one a ray. Appends
  /// the children outside that it hits to `exits`, with the ray's place in `members` and the depth below `from`, in the
  /// order in which it has met them; those of one node in the order in which they would be visited.
  virtual void trace_treelets(std::span<const accel::NodeKey> from, const accel::RayMembers& members,
                              std::vector<PacketExit>& exits, IntersectionCounts& counts) = 0;
};

}  // namespace carousel::ringbus
