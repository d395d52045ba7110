#pragma once

#include "core/statistics/bundle_counts.h"
#include "core/statistics/intersection_counts.h"
#include "report/sections/visitor.h"

namespace carousel::report {

/// A count in all and for each of so many completed rays.
struct PerRay {
  std::uint64_t count = 0, rays = 0;
  const char* unit = "tests";
};

template <class V>
void describe(V& v, const PerRay& r) {
  v.field("count", r.count, r.unit, "count over all rays");
  v.field("per_ray", ratio(r.count, r.rays), (std::string(r.unit) + "/ray").c_str(), "mean for each completed ray");
}

/// Bundles at one depth.
struct BundleDepth {
  std::uint64_t depth = 0;
  BundleCounts counts;
};

template <class V>
void describe(V& v, const BundleDepth& r) {
  v.field("depth", r.depth, "strips", "depth below the root; in the sum, the greatest depth");
  describe(v, r.counts);
  v.field("box_tests_spared", r.counts.box_tests_spared(), "tests",
          "tests of a ray against a box that were not needed");
  v.field("ray_reads_spared", r.counts.ray_reads_spared(), "records",
          "records of rays not read, less those read because bundles split or dissolved");
}

struct Bundles {
  std::vector<BundleCounts> by_depth;  ///< not empty in a run with bundles
  std::uint64_t record_bytes = 0;      ///< size of a ray's record

  BundleDepth sum() const {
    BundleDepth all;
    for (const BundleCounts& counts : by_depth) all.counts += counts;
    if (!by_depth.empty()) all.depth = by_depth.size() - 1;
    return all;
  }
};

template <class V>
void describe(V& v, const Bundles& r) {
  const BundleDepth sum = r.sum();
  std::vector<BundleDepth> depths;
  for (const BundleCounts& counts : r.by_depth) depths.push_back({depths.size(), counts});
  v.field("formed", sum.counts.formed, "bundles", "bundles formed of new rays and of the rays of split bundles");
  v.field("rays_mean", ratio(sum.counts.formed_rays, sum.counts.formed), "rays/bundle", "rays of a bundle when formed");
  v.section("sum", sum, "outcome over all depths");
  v.field("ray_bytes_spared", sum.counts.ray_reads_spared() * static_cast<std::int64_t>(r.record_bytes), "bytes",
          "bytes of the records spared");
  v.section("by_depth", depths, "outcome at each depth from the root down");
}

/// Tests of a depth-first tracer on the same structure, for some of the rays of the run or all of them.
struct DepthFirst {
  std::uint64_t rays = 0, one_in = 1;
  IntersectionCounts counts;
};

template <class V>
void describe(V& v, const DepthFirst& r) {
  v.field("rays", r.rays, "rays", "completed rays of the run that were traced again");
  v.field("one_in", r.one_in, "rays", "one ray in so many was chosen, by its origin and direction; 1: every ray");
  v.section("box", PerRay{r.counts.box, r.rays}, "tests of a ray against a box");
  v.section("triangle", PerRay{r.counts.triangle, r.rays}, "tests of a ray against a triangle");
  v.section("plane", PerRay{r.counts.plane, r.rays}, "tests of a ray against a cull plane");
  v.section("procedural", PerRay{r.counts.procedural, r.rays}, "tests of a ray against a procedural primitive");
  v.section("transforms", PerRay{r.counts.transforms, r.rays, "rays"}, "transformations of a ray to model space");
}

struct Tests {
  IntersectionCounts counts;
  std::uint64_t ray_reads = 0;
  std::uint64_t rays = 0;  ///< completed
  RunFeatures features;
  std::optional<Bundles> bundles{};
  std::optional<DepthFirst> depth_first{};

  PerRay per_ray(const Counter<IntersectionCounts>& row) const { return {row.value(counts), rays, row.unit}; }
};

template <class V>
void describe(V& v, const Tests& r) {
  for (const Counter<IntersectionCounts>& row : kCounters<IntersectionCounts>) {
    if (row.shown == Shown::kAlways)
      v.section(row.name, r.per_ray(row), row.meaning);
    else
      v.section_if(r.features.show(row.shown), row.name, r.per_ray(row), row.meaning);
  }
  v.section("ray_reads", PerRay{r.ray_reads, r.rays}, "records of rays or bundles read by testers");
  v.section("bundles", r.bundles, "outcome of testing rays in bundles, with bundles.size");
  v.section("depth_first", r.depth_first,
            "the baseline: tests of a depth-first tracer that takes one ray after another, nearest child first");
}

}  // namespace carousel::report
