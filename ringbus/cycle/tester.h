#pragma once

#include "accel/instance_data.h"
#include "core/config.h"
#include "core/ids.h"
#include "core/test_counts.h"
#include "ringbus/cycle/cycle_result.h"
#include "ringbus/cycle/level_cycles.h"
#include "ringbus/cycle/unit_bank.h"

namespace carousel::ringbus::cycle {

/// A resource's test units. Transforms, boxes and triangles are pipelined: a ray's boxes are tested when it has
/// been transformed, while the next one is, and its planes when its boxes have been. A matrix that is inverted first takes its passes through the transform
/// unit ahead of the rays. Records of rays and bundles come from the store one after another if its port is narrow, and
/// rays that leave a bundle are tested after it.
struct Tester {
  /// `reads_per_cycle`: as rays.reads_per_cycle.
  explicit Tester(const TestersConfig& config, std::int64_t reads_per_cycle = 0)
      : box(config.box),
        triangle(config.triangle),
        plane(config.plane),
        bundle(config.bundle),
        transform(config.transform),
        store({std::max<std::int64_t>(1, reads_per_cycle), 1, 0}),
        reads_cost_(reads_per_cycle > 0) {}

  /// When the answers to the tests of one strip are there; started at `at`, for `reads` records, with so many passes through
  /// the bundle units.
  Cycle strip(Cycle at, const TestCounts& counts, std::uint64_t reads = 0, std::uint64_t bundle_passes = 0) {
    const UnitBank::Reservation read = store.reserve(at, reads_cost_ ? reads : 0);
    const UnitBank::Reservation bundled = bundle.reserve(read.first, bundle_passes);
    const UnitBank::Reservation moved = transform.reserve(inverted(bundled.first, counts), counts.transforms);
    UnitBank& bank = counts.box > 0 ? box : triangle;
    const UnitBank::Reservation tested = bank.reserve(moved.first, counts.box + counts.triangle);
    // What is last to be read, to be transformed or to leave its bundle is tested last.
    Cycle last = std::max(tested.last, bundled.last);
    if (bundle_passes > 0) last = std::max(last, read.last + bundle.latency());
    if (counts.transforms > 0) last = std::max(last, moved.last + bank.latency());
    if (counts.box + counts.triangle > 0) last = std::max(last, std::max(read.last, bundled.last) + (reads_cost_ || bundle_passes > 0 ? bank.latency() : 0));
    if (counts.plane == 0) return last;
    return std::max(plane.reserve(tested.first, counts.plane).last, last + plane.latency());
  }

  /// The same for a walk through a subtree, whose slowest ray needs `chain` cycles for its tests one by one.
  Cycle walk(Cycle at, const TestCounts& counts, Cycle chain, std::uint64_t reads = 0) {
    return std::max({at + chain, store.reserve(at, reads_cost_ ? reads : 0).last, transform.reserve(at, passes(counts)).last, box.reserve(at, counts.box).last,
                     plane.reserve(at, counts.plane).last, triangle.reserve(at, counts.triangle).last});
  }

  /// The same for a single ray, beside others.
  Cycle ray(Cycle at, const TestCounts& counts) {
    const Cycle moved = transform.reserve_beside(inverted(at, counts), counts.transforms).last;
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
  static std::uint64_t passes(const TestCounts& counts) {
    return counts.transforms + accel::kInversionPasses * counts.inversions;
  }
  Cycle inverted(Cycle at, const TestCounts& counts) {
    return transform.reserve(at, accel::kInversionPasses * counts.inversions).last;
  }

  bool reads_cost_;
};

/// Those of a resource, at the levels of accuracy: the machine's, unless it has its own.
inline TestersConfig testers_of(const Config& config, ResourceId id) {
  for (const ResourceOverride& one : config.topology.overrides)
    if (one.resource == id.value) return at_levels(one.testers, config.accuracy);
  return at_levels(config.testers, config.accuracy);
}

}  // namespace carousel::ringbus::cycle
