#pragma once

#include <cstdint>
#include <vector>

#include "accel/structure/accel.h"
#include "core/statistics/intersection_counts.h"
#include "ringbus/cycle/tile/walk/ray_walk.h"
#include "ringbus/cycle/tile/walk/walk_steps.h"
#include "ringbus/resource/resource.h"

namespace carousel::ringbus::cycle {

/// Takes rays through a subtree, depth-first, a strip at a time, and writes down their ways for the
/// clock to follow (SubtreeVisits). The kernels' own walk is faster on the host but writes nothing down.
class SubtreeWalk final : public SubtreeTracer {
 public:
  /// Keeps references.
  SubtreeWalk(const accel::Accel& accel, TransformAccount& transforms, ChildOrder order)
      : accel_(accel), walk_(transforms, order) {}

  void trace(accel::NodeKey from, const accel::RayMembers& members, IntersectionCounts& counts) override;
  void trace_treelets(std::span<const accel::NodeKey> from, const accel::RayMembers& members,
                      std::vector<PacketExit>& exits, IntersectionCounts& counts) override;
  /// The ways of the last trace. The caller may take them away.
  WalkSteps& ways() { return ways_; }

 private:
  void begin();
  void walk_ray(const accel::RayMembers& ray, IntersectionCounts& counts);
  bool inverts_first(std::uint32_t instance);

  const accel::Accel& accel_;
  WalkSteps ways_;
  RayWalk walk_;
  std::vector<std::uint32_t> inverted_;  // instances whose matrix any of the rays needs inverted
};

}  // namespace carousel::ringbus::cycle
