#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/statistics/bundle_counts.h"
#include "core/statistics/intersection_counts.h"
#include "core/statistics/node_counts.h"
#include "core/types/workload.h"
#include "ringbus/packets/packet.h"

namespace carousel::ringbus {

/// Passes of a packet's bundles through the units that test them (US 11308683, FIG. 11 and 12): one a test, or one an
/// edge of a silhouette.
struct BundlePasses {
  std::uint32_t first = 0;           ///< passes of the tests that are made at once
  std::uint32_t second = 0;          ///< passes of the tests that the answers to the first call for
  std::uint32_t at_once = 0;         ///< as `first`, where a pair of blocks makes both tests of a box at the same time
  std::uint32_t divided_before = 0;  ///< divisions for directions, for which the first tests wait
  std::uint32_t divided_after = 0;   ///< divisions for distances of boxes, which wait for the last tests
  std::uint32_t regrouped = 0;       ///< rays that the builder then puts into new bundles
};

/// The cost of testing a packet at one resource. The pointer and the spans are valid until the resource's next test.
struct TestOutcome {
  IntersectionCounts counts;
  std::size_t rays = 0;        ///< tested one by one, not as members of a bundle
  std::uint32_t reads = 0;     ///< records of rays and bundles that were read
  std::uint32_t children = 0;  ///< rays that go on to a child, once for each child; not within treelets
  std::uint32_t misses = 0;    ///< rays that were tested against the children of a node and go on to none
  BundlePasses bundle_passes;
  const BundleCounts* bundles = nullptr;  ///< counts of tests and splits of bundles; null when there are none
  /// With ResourceHooks::hold_any_hit_rays: the rays that wait for Resource::release().
  std::span<const std::uint32_t> any_hit_slots;
  std::span<const RayResult> any_hit_calls;  ///< their calls
  /// Where rays of one packet are at several nodes: the node of each ray, and the work at each node. Otherwise empty.
  std::span<const NextNode> nodes;
  std::span<const NodeCountsAtDepth> runs;
};

}  // namespace carousel::ringbus
