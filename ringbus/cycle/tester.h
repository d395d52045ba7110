#pragma once

#include "accel/instance_data.h"
#include "core/config.h"
#include "core/ids.h"
#include "core/test_counts.h"
#include "ringbus/cycle/cycle_result.h"
#include "ringbus/cycle/level_cycles.h"
#include "ringbus/cycle/unit_bank.h"
#include "ringbus/faults/resource_fault.h"

namespace carousel::ringbus::cycle {

/// A resource's test units. Transforms, boxes and triangles are pipelined: a ray's boxes are tested when it has
/// been transformed, while the next one is, and its planes when its boxes have been; or its planes first, and then the
/// boxes that are left. A matrix that is inverted first takes its passes through the transform unit ahead of the rays.
/// Records of rays and bundles come from the store one after another if its port is narrow, each a cycle after it is
/// asked for, and rays that leave a bundle are tested after it.
struct Tester {
  using Order = CullPlanesConfig::Order;
  /// `reads_per_cycle`: as rays.reads_per_cycle.
  explicit Tester(const TestersConfig& config, Order order = Order::kBoxFirst, std::int64_t reads_per_cycle = 0)
      : box(config.box),
        triangle(config.triangle),
        plane(config.plane),
        bundle(config.bundle),
        transform(config.transform),
        store({std::max<std::int64_t>(1, reads_per_cycle), 1, 1}),
        order_(order),
        reads_cost_(reads_per_cycle > 0) {}

  /// When the answers to the tests of one strip are there; started at `at`, for `reads` records, with so many passes
  /// through the bundle units.
  Cycle strip(Cycle at, const TestCounts& counts, std::uint64_t reads = 0, std::uint64_t bundle_passes = 0) {
    const UnitBank::Reservation bundled = tested(bundle, store.reserve(at, reads_cost_ ? reads : 0), bundle_passes);
    const Cycle inverse = inverted(bundled.first, counts);
    const UnitBank::Reservation moved = tested(transform, {inverse, std::max(inverse, bundled.last)}, counts.transforms);
    if (counts.plane == 0) return tested(counts.box > 0 ? box : triangle, moved, counts.box + counts.triangle).last;
    if (order_ == Order::kBoxFirst) return tested(plane, tested(box, moved, counts.box), counts.plane).last;
    const UnitBank::Reservation planes = tested(plane, moved, counts.plane);
    return counts.box > 0 ? tested(box, planes, counts.box).last : planes.last;
  }

  /// The same for a walk through a subtree, whose slowest ray needs `chain` cycles for its tests one by one.
  Cycle walk(Cycle at, const TestCounts& counts, Cycle chain, std::uint64_t reads = 0) {
    return std::max({at + chain, store.reserve(at, reads_cost_ ? reads : 0).last,
                     transform.reserve(at, passes(counts)).last, box.reserve(at, counts.box).last,
                     plane.reserve(at, counts.plane).last, triangle.reserve(at, counts.triangle).last});
  }

  /// The same for a single ray, beside others.
  Cycle ray(Cycle at, const TestCounts& counts) {
    const Cycle moved = transform.reserve_beside(inverted(at, counts), counts.transforms).last;
    if (order_ == Order::kPlanesFirst && counts.plane > 0)
      return box.reserve_beside(plane.reserve_beside(moved, counts.plane).last, counts.box).last;
    UnitBank& bank = counts.box > 0 ? box : triangle;
    const Cycle tested = bank.reserve_beside(moved, counts.box + counts.triangle).last;
    return plane.reserve_beside(tested, counts.plane).last;
  }

  /// Fills in how long each bank was busy.
  void account(TileResult& result) const {
    result.box.busy = box.busy();
    result.triangle.busy = triangle.busy();
    result.plane.busy = plane.busy();
    result.bundle.busy = bundle.busy();
    result.ray_reads.busy = store.busy();
    result.transform.busy = transform.busy();
  }

  UnitBank box, triangle, plane, bundle, transform;
  UnitBank store;   ///< the port of the ray store

 private:
  /// Tests for rays that come one after another from the bank before: the last of them is tested last.
  static UnitBank::Reservation tested(UnitBank& bank, const UnitBank::Reservation& before, std::uint64_t tests) {
    if (tests == 0) return before;
    const UnitBank::Reservation own = bank.reserve(before.first, tests);
    return {own.first, before.last > before.first ? std::max(own.last, before.last + bank.latency()) : own.last};
  }
  static std::uint64_t passes(const TestCounts& counts) {
    return counts.transforms + accel::kInversionPasses * counts.inversions;
  }
  Cycle inverted(Cycle at, const TestCounts& counts) {
    return transform.reserve(at, accel::kInversionPasses * counts.inversions).last;
  }

  Order order_;
  bool reads_cost_;
};

/// Those of a resource, at the levels of accuracy: the machine's, unless it has its own.
inline TestersConfig testers_of(const Config& config, ResourceId id) {
  TestersConfig testers = config.testers;
  for (const ResourceOverride& one : config.topology.overrides)
    if (one.resource == id.value) testers = one.testers;
  slow_down(testers, config.faults, id);
  return at_levels(testers, config.accuracy);
}

}  // namespace carousel::ringbus::cycle
