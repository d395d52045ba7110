#pragma once

#include <string>
#include <vector>

#include "report/sections/visitor.h"

namespace carousel::report {

/// A value of the whole frame, estimated from a sample of it.
struct SampledValue {
  double estimate = 0, low = 0, high = 0;
  std::optional<double> whole{}, error{};
  const char* unit = "";
};

template <class V>
void describe(V& v, const SampledValue& r) {
  v.field("estimate", r.estimate, r.unit, "estimate for the whole frame");
  v.field("low", r.low, r.unit, "lower end of its interval of confidence (95 %)");
  v.field("high", r.high, r.unit, "upper end of its interval of confidence (95 %)");
  v.field("whole", r.whole, r.unit, "value of the whole frame, with --audit");
  v.field("error", r.error, "fraction", "estimate over that value, less 1");
}

/// The energy of a ray.
struct SampledEnergy : SampledValue {
  SampledEnergy() { unit = "nJ/ray"; }
};

/// The use of a class of parts.
struct SampledUse {
  std::string name;
  SampledValue use{.unit = "fraction"};
};

template <class V>
void describe(V& v, const SampledUse& r) {
  v.field("name", r.name, "", "class of parts, as in bound");
  describe(v, r.use);
}

/// Estimates of the whole frame from a run over a part of it. All other sections are about that part alone.
struct Sampled {
  std::uint64_t paths = 0, frame_paths = 0, strata = 0;
  double steady = 0;
  bool too_small = false;
  std::string picture{};
  SampledValue cycles_per_ray{.unit = "cycles/ray"}, cycles{.unit = "cycles"}, rays{.unit = "rays"},
      rays_per_kilocycle{.unit = "rays/1000 cycles"}, box_tests_per_ray{.unit = "tests/ray"},
      triangle_tests_per_ray{.unit = "tests/ray"}, memory_bytes_per_ray{.unit = "bytes/ray"},
      link_bytes_per_ray{.unit = "bytes/ray"};
  std::optional<SampledEnergy> nj_per_ray{};
  std::vector<SampledUse> uses{};

  /// Calls `body(key, meaning, value)` for each value but those of `uses`.
  template <class Self, class Body>
  static void for_each(Self& self, const Body& body) {
    body("cycles_per_ray", "simulated cycles over rays", self.cycles_per_ray);
    body("cycles", "simulated cycles of the frame", self.cycles);
    body("rays", "rays of the frame", self.rays);
    body("rays_per_kilocycle", "rays over cycles", self.rays_per_kilocycle);
    body("box_tests_per_ray", "tests of a ray against a box", self.box_tests_per_ray);
    body("triangle_tests_per_ray", "tests of a ray against a triangle", self.triangle_tests_per_ray);
    body("memory_bytes_per_ray", "bytes read from the memory and written to it", self.memory_bytes_per_ray);
    body("link_bytes_per_ray", "bytes of packets on links", self.link_bytes_per_ray);
  }
};

template <class V>
void describe(V& v, const Sampled& r) {
  v.field("paths", r.paths, "paths", "paths that were simulated, or rays of a list");
  v.field("frame_paths", r.frame_paths, "paths", "paths of the whole frame");
  v.field("strata", r.strata, "strata", "parts of the frame with a place that was simulated");
  v.field("steady", r.steady, "fraction", "part of the sample's rays that were completed between fill and drain");
  v.field("too_small", r.too_small, "",
          "true if the sample is mostly fill and drain of this machine: the intervals are then wide, and a larger "
          "fraction is needed");
  v.field("picture", r.picture, "", "content of image.png and image.exr; empty if there are none");
  Sampled::for_each(
      r, [&](const char* key, const char* meaning, const SampledValue& value) { v.section(key, value, meaning); });
  v.section("nj_per_ray", r.nj_per_ray, "energy of a ray as energy.nj_per_ray, with the frame's bytes of the memory");
  v.section("uses", r.uses, "part of the frame's time in which the parts of a class work, class by class");
}

}  // namespace carousel::report
