#pragma once

#include <cstdint>
#include <unordered_set>
#include <vector>

#include "accel/structure/accel.h"
#include "core/statistics/intersection_counts.h"
#include "core/types/unit_kind.h"
#include "ringbus/cycle/testers/unit_passes.h"
#include "ringbus/cycle/tile/walk/ray_walk.h"
#include "ringbus/resource/resource.h"

namespace carousel::ringbus::cycle {

/// A strip that a ray comes to, and its tests there.
struct WalkStep {
  accel::NodeKey key;
  RayTests tests;  ///< with an inversion wherever the ray needs one, also if another ray's will do
};
static_assert(sizeof(WalkStep) <= sizeof(accel::NodeKey) + 2 * kUnitKinds.size() + 8);  // as small as it can be

/// The ways of a visit's rays, one behind the other.
struct WalkSteps {
  std::vector<WalkStep> steps;
  std::vector<std::uint32_t> ends;  ///< by ray: the end of its steps
};

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

  const accel::Accel& accel_;
  WalkSteps ways_;
  RayWalk walk_;
  std::unordered_set<std::uint32_t> inverted_;  // instances whose matrix any of the rays needs inverted
};

}  // namespace carousel::ringbus::cycle
