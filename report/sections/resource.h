#pragma once

#include "core/statistics/collection_counts.h"
#include "core/statistics/intersection_counts.h"
#include "core/statistics/ray_bytes.h"
#include "core/statistics/resource_counts.h"
#include "core/statistics/stall_counts.h"
#include "report/sections/units.h"

namespace carousel::report {

struct Resource {
  std::uint64_t resource = 0;
  ResourceCounts counts{};
  IntersectionCounts tests{};
  CollectionCounts collections{};
  std::optional<StallCounts> stalls{};
  std::optional<std::uint64_t> reserve_entered{};
  std::optional<Units> units{};
  std::optional<StackTraffic> stack{};
  std::optional<TransformedRayBytes> transformed_rays{};
};

template <class V>
void describe(V& v, const Resource& r) {
  v.field("resource", r.resource, "", "number of the resource");
  describe(v, r.counts);
  v.field("box_tests", r.tests.box, "tests", "tests of a ray against a box");
  v.field("triangle_tests", r.tests.triangle, "tests", "tests of a ray against a triangle");
  v.field("transforms", r.tests.transforms, "rays", "rays transformed to model space");
  describe(v, r.collections);
  v.section("stalls", r.stalls, "attempts of worker threads that could not proceed, by reason (native)");
  v.field("reserve_entered", r.reserve_entered, "packets",
          "packets issued alone, deepest first, since too few collection blocks were free for others (cycle)");
  v.section("units", r.units, "cycles of the resource's units; those of each unit add up to engine.cycles");
  v.section("stack", r.stack, "traffic of the stacks of its rays, with topology.shape: independent");
  v.section("transformed_rays", r.transformed_rays,
            "model-space rays kept beside the records, with accuracy.transformed_ray: store");
}

}  // namespace carousel::report
