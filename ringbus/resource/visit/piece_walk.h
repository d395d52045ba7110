#pragma once

#include <span>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/fields/collections.h"
#include "ringbus/resource/visit/subtree_tracer.h"

namespace carousel::ringbus {

/// Takes rays through treelets of the whole tree by the kernels, a node at a time, for an engine without a clock.
class PieceWalk final : public SubtreeTracer {
 public:
  /// Keeps a reference.
  PieceWalk(const accel::Accel& accel, ChildOrder order) : accel_(accel), order_(order) {}

  void trace(accel::NodeKey from, const accel::RayMembers& members, IntersectionCounts& counts) override;
  void trace_treelets(std::span<const accel::NodeKey> from, const accel::RayMembers& members,
                      std::vector<PacketExit>& exits, IntersectionCounts& counts) override;

 private:
  const accel::Accel& accel_;
  ChildOrder order_;
  std::vector<NextNode> stack_;  // scratch
};

}  // namespace carousel::ringbus
