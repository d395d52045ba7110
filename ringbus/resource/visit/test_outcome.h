#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/statistics/bundle_counts.h"
#include "core/statistics/intersection_counts.h"

namespace carousel::ringbus {

/// A ray that made any-hit calls during a test, and how many.
struct AnyHitCall {
  std::uint32_t slot, times;
};

/// The cost of testing a packet at one resource. The pointer and the span are valid until the resource's next test.
struct TestOutcome {
  IntersectionCounts counts;
  std::size_t rays = 0;                   ///< tested one by one, not as members of a bundle
  std::uint32_t reads = 0;                ///< records of rays and bundles that were read
  std::uint32_t bundle_passes = 0;        ///< through a bundle unit: one a test, or one an edge of a silhouette
  const BundleCounts* bundles = nullptr;  ///< what became of bundles; null when there are none
  /// With ResourceHooks::hold_any_hit_rays: the rays that wait for Resource::release().
  std::span<const AnyHitCall> any_hit_calls;
};

}  // namespace carousel::ringbus
