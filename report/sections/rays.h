#pragma once

#include <optional>
#include <vector>

#include "core/statistics/bounce_counts.h"
#include "report/sections/distribution.h"
#include "report/sections/visitor.h"

namespace carousel::report {

struct RaysByKind {
  std::uint64_t camera = 0, bounce = 0, shadow = 0;
};

template <class V>
void describe(V& v, const RaysByKind& r) {
  v.field("camera", r.camera, "rays", "rays from the camera");
  v.field("bounce", r.bounce, "rays", "rays from a surface that seek the closest hit");
  v.field("shadow", r.shadow, "rays", "rays from a surface that seek any hit");
}

/// The rays of one bounce.
struct RayBounce {
  std::uint64_t bounce = 0;
  BounceCounts counts;
};

template <class V>
void describe(V& v, const RayBounce& r) {
  v.field("bounce", r.bounce, "surfaces",
          "surfaces that the path had met before; a shadow ray has that of its surface");
  describe(v, r.counts);
}

struct Rays {
  std::uint64_t emitted = 0, completed = 0, lost = 0, restarted = 0, paths_restarted = 0;
  RaysByKind by_kind;
  std::optional<std::vector<RayBounce>> by_bounce{};
  std::optional<Distribution> residence{};
};

template <class V>
void describe(V& v, const Rays& r) {
  v.field("emitted", r.emitted, "rays", "rays emitted by shading");
  v.field("completed", r.completed, "rays", "rays returned to shading");
  v.field("lost", r.lost, "rays", "rays emitted and never completed; 0 in a complete run");
  v.field("restarted", r.restarted, "rays", "unfinished rays traced again from the root after a resource stopped");
  v.field("paths_restarted", r.paths_restarted, "(pixel, sample)s",
          "paths of the restarted rays; light gathered before was kept");
  v.section("by_kind", r.by_kind, "emitted rays by kind");
  v.section("by_bounce", r.by_bounce, "way of the rays from the camera through the bounces, bounce by bounce");
  v.section("residence", r.residence,
            "time from the cycle in which ray control gives a ray its slot until shading has its hit (cycle)");
}

}  // namespace carousel::report
