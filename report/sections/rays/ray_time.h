#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/statistics/ray_stage_counts.h"
#include "report/sections/visitor.h"

namespace carousel::report {

/// The cycles of the rays of one kind and bounce.
struct RayTimeOf {
  std::string kind;
  std::uint64_t bounce = 0, rays = 0;
  RayStageCounts stages;
};

template <class V>
void describe(V& v, const RayTimeOf& r) {
  v.field("kind", r.kind, "", "camera, bounce or shadow");
  v.field("bounce", r.bounce, "surfaces",
          "surfaces that the path had met before; a shadow ray has that of its surface");
  v.field("rays", r.rays, "rays", "such rays");
  v.field("cycles", cycles_of(r.stages), "cycles", "their cycles in all stages together");
  describe(v, r.stages);
}

/// Where the cycles of all rays go.
struct RayTime {
  std::vector<RayTimeOf> by_kind;

  std::uint64_t rays() const {
    std::uint64_t sum = 0;
    for (const RayTimeOf& of : by_kind) sum += of.rays;
    return sum;
  }
  RayStageCounts stages() const {
    RayStageCounts sum;
    for (const RayTimeOf& of : by_kind) sum += of.stages;
    return sum;
  }
};

template <class V>
void describe(V& v, const RayTime& r) {
  const std::uint64_t cycles = cycles_of(r.stages());
  v.field("rays", r.rays(), "rays", "rays, all of them");
  v.field("latency", ratio(cycles, r.rays()), "cycles", "mean time of a ray from its making until it had been shaded");
  v.field("cycles", cycles, "cycles", "these times of all rays together: the sum of the stages below");
  describe(v, r.stages());
  v.section("by_kind", r.by_kind, "the same by kind and bounce");
}

}  // namespace carousel::report
