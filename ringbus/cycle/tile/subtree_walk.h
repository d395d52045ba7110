#pragma once

#include <cstdint>
#include <unordered_set>
#include <vector>

#include "accel/structure/accel.h"
#include "core/statistics/intersection_counts.h"
#include "core/types/unit_kind.h"
#include "ringbus/cycle/tile/ray_walk.h"
#include "ringbus/resource/resource.h"

namespace carousel::ringbus::cycle {

/// Takes rays through a subtree, depth-first and nearest first, a strip at a time, and keeps an account of the work of
/// the hardware that does so. The kernels' own walk is faster on the host but keeps no account.
class SubtreeWalk final : public SubtreeTracer {
 public:
  /// Cycles that one ray waits for its tests of each kind in a strip, and for each pass through a transform unit.
  using StepCycles = PerUnit<std::uint64_t>;
  struct Account {
    std::uint64_t chain = 0;               ///< cycles of the slowest ray
    std::vector<accel::NodeKey> strips;    ///< read by any ray, once each, in order of the first reading
    std::vector<std::uint32_t> instances;  ///< whose transform was read, likewise
  };
  /// Keeps references.
  SubtreeWalk(const accel::Accel& accel, const StepCycles& step, TransformAccount& transforms)
      : accel_(accel), step_(step), walk_(transforms) {}

  void trace(accel::NodeKey from, const accel::RayMembers& members, IntersectionCounts& counts) override;
  /// The account of the last trace().
  const Account& account() const { return account_; }

 private:
  std::uint64_t walk_ray(accel::NodeKey from, const accel::RayMembers& ray, std::uint8_t* any_hit_calls,
                         IntersectionCounts& counts);
  void note(accel::NodeKey key);

  const accel::Accel& accel_;
  StepCycles step_;
  Account account_;
  RayWalk walk_;
  std::unordered_set<std::uint32_t> entered_;  // instances by any of the rays
  std::vector<std::uint32_t> seen_;            // by a hash of the strip: its place in account_.strips, plus one
};

}  // namespace carousel::ringbus::cycle
