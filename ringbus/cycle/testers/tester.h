#pragma once

#include "accel/transform/instance_data.h"
#include "core/config/config.h"
#include "core/statistics/intersection_counts.h"
#include "core/types/ids.h"
#include "ringbus/cycle/testers/level_cycles.h"
#include "ringbus/cycle/testers/unit_bank.h"
#include "ringbus/faults/resource_fault.h"
#include "ringbus/results/cycle_result.h"

namespace carousel::ringbus::cycle {

/// A resource's test units. Transforms, boxes and triangles are pipelined: a ray's boxes are tested when it has
/// been transformed, while the next one is, and its planes when its boxes have been; or its planes first, and then the
/// boxes that are left. A matrix that is inverted first takes its passes through the transform unit ahead of the rays.
/// Records of rays and bundles come from the store one after another if its port is narrow, each a cycle after it is
/// asked for, and rays that leave a bundle are tested after it. Triangles and procedural primitives are tested like
/// boxes, and beside them where a node holds both; then, with any_hit: inline, whether they let rays through is looked
/// up.
struct Tester {
  using Order = CullPlanesConfig::Order;
  /// `reads_per_cycle`: as rays.reads_per_cycle.
  explicit Tester(const TestersConfig& config, Order order = Order::kBoxFirst, std::int64_t reads_per_cycle = 0)
      : box(config.units[UnitKind::kBox]),
        triangle(config.units[UnitKind::kTriangle]),
        plane(config.units[UnitKind::kPlane]),
        bundle(config.units[UnitKind::kBundle]),
        transform(config.units[UnitKind::kTransform]),
        procedural(config.units[UnitKind::kProcedural]),
        any_hit(config.units[UnitKind::kAnyHit]),
        store({std::max<std::int64_t>(1, reads_per_cycle), 1, 1}),
        order_(order),
        reads_cost_(reads_per_cycle > 0),
        inline_(config.any_hit == TestersConfig::AnyHit::kInline) {}

  /// When the answers to the tests of one strip are there; started at `at`, for `reads` records, with so many passes
  /// through the bundle units.
  Cycle strip(Cycle at, const IntersectionCounts& counts, std::uint64_t reads = 0, std::uint64_t bundle_passes = 0) {
    const UnitBank::Reservation bundled = tested(bundle, store.reserve(at, reads_cost_ ? reads : 0), bundle_passes);
    const Cycle inverse = inverted(bundled.first, counts);
    const UnitBank::Reservation moved =
        tested(transform, {inverse, std::max(inverse, bundled.last)}, counts.transforms);
    return std::max(boxes(moved, counts), primitives(moved, counts));
  }

  /// The same for a walk through a subtree, whose slowest ray needs `chain` cycles for its tests one by one.
  Cycle walk(Cycle at, const IntersectionCounts& counts, Cycle chain, std::uint64_t reads = 0) {
    return std::max({at + chain, store.reserve(at, reads_cost_ ? reads : 0).last,
                     transform.reserve(at, passes(counts)).last, box.reserve(at, counts.box).last,
                     plane.reserve(at, counts.plane).last, triangle.reserve(at, counts.triangle).last,
                     procedural.reserve(at, counts.procedural).last, any_hit.reserve(at, lookups(counts)).last});
  }

  /// The same for a single ray, beside others.
  Cycle ray(Cycle at, const IntersectionCounts& counts) {
    const Cycle moved = transform.reserve_beside(inverted(at, counts), counts.transforms).last;
    const bool planes_first = order_ == Order::kPlanesFirst && counts.plane > 0;
    const Cycle boxed = planes_first
                            ? box.reserve_beside(plane.reserve_beside(moved, counts.plane).last, counts.box).last
                            : plane.reserve_beside(box.reserve_beside(moved, counts.box).last, counts.plane).last;
    const Cycle met = std::max(triangle.reserve_beside(moved, counts.triangle).last,
                               procedural.reserve_beside(moved, counts.procedural).last);
    return std::max(boxed, any_hit.reserve_beside(met, lookups(counts)).last);
  }

  /// Fills in how long each bank was busy.
  void account(TileResult& result) const {
    result.box.busy = box.busy();
    result.triangle.busy = triangle.busy();
    result.plane.busy = plane.busy();
    result.bundle.busy = bundle.busy();
    result.ray_reads.busy = store.busy();
    result.transform.busy = transform.busy();
    result.procedural.busy = procedural.busy();
    result.any_hit.busy = any_hit.busy();
  }

  UnitBank box, triangle, plane, bundle, transform, procedural, any_hit;
  UnitBank store;  ///< the port of the ray store

 private:
  /// Tests for rays that come one after another from the bank before: the last of them is tested last.
  static UnitBank::Reservation tested(UnitBank& bank, const UnitBank::Reservation& before, std::uint64_t tests) {
    if (tests == 0) return before;
    const UnitBank::Reservation own = bank.reserve(before.first, tests);
    return {own.first, before.last > before.first ? std::max(own.last, before.last + bank.latency()) : own.last};
  }
  Cycle boxes(const UnitBank::Reservation& moved, const IntersectionCounts& counts) {
    if (order_ == Order::kBoxFirst || counts.plane == 0)
      return tested(plane, tested(box, moved, counts.box), counts.plane).last;
    return tested(box, tested(plane, moved, counts.plane), counts.box).last;
  }
  Cycle primitives(const UnitBank::Reservation& moved, const IntersectionCounts& counts) {
    UnitBank::Reservation met = tested(triangle, moved, counts.triangle);
    if (counts.procedural > 0) {
      const UnitBank::Reservation others = tested(procedural, moved, counts.procedural);
      met = {std::max(met.first, others.first), std::max(met.last, others.last)};
    }
    return tested(any_hit, met, lookups(counts)).last;
  }
  std::uint64_t lookups(const IntersectionCounts& counts) const { return inline_ ? counts.any_hit_calls : 0; }
  static std::uint64_t passes(const IntersectionCounts& counts) {
    return counts.transforms + accel::kInversionPasses * counts.inversions;
  }
  Cycle inverted(Cycle at, const IntersectionCounts& counts) {
    return transform.reserve(at, accel::kInversionPasses * counts.inversions).last;
  }

  Order order_;
  bool reads_cost_, inline_;
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
