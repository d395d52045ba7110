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
/// unit ahead of the rays.
struct Tester {
  explicit Tester(const TestersConfig& config)
      : box(config.box), triangle(config.triangle), plane(config.plane), transform(config.transform) {}

  /// When the answers to the tests of one strip are there; started at `at`.
  Cycle strip(Cycle at, const TestCounts& counts) {
    const UnitBank::Reservation moved = transform.reserve(inverted(at, counts), counts.transforms);
    UnitBank& bank = counts.box > 0 ? box : triangle;
    const UnitBank::Reservation tested = bank.reserve(moved.first, counts.box + counts.triangle);
    // The last ray to be transformed is tested last.
    const Cycle last = counts.transforms > 0 ? std::max(tested.last, moved.last + bank.latency()) : tested.last;
    if (counts.plane == 0) return last;
    return std::max(plane.reserve(tested.first, counts.plane).last, last + plane.latency());
  }

  /// The same for a walk through a subtree, whose slowest ray needs `chain` cycles for its tests one by one.
  Cycle walk(Cycle at, const TestCounts& counts, Cycle chain) {
    return std::max({at + chain, transform.reserve(at, passes(counts)).last, box.reserve(at, counts.box).last,
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
    result.transform.busy = transform.busy();
  }

  UnitBank box, triangle, plane, transform;

 private:
  static std::uint64_t passes(const TestCounts& counts) {
    return counts.transforms + accel::kInversionPasses * counts.inversions;
  }
  Cycle inverted(Cycle at, const TestCounts& counts) {
    return transform.reserve(at, accel::kInversionPasses * counts.inversions).last;
  }
};

/// Those of a resource, at the levels of accuracy: the machine's, unless it has its own.
inline TestersConfig testers_of(const Config& config, ResourceId id) {
  for (const ResourceOverride& one : config.topology.overrides)
    if (one.resource == id.value) return at_levels(one.testers, config.accuracy);
  return at_levels(config.testers, config.accuracy);
}

}  // namespace carousel::ringbus::cycle
