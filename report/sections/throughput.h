#pragma once

#include "report/sections/visitor.h"

namespace carousel::report {

/// Simulated speed.
struct Rate {
  double rays_per_kilocycle = 0, mrays_per_second_at_clock = 0;
};

template <class V>
void describe(V& v, const Rate& r) {
  v.field("rays_per_kilocycle", r.rays_per_kilocycle, "rays/1000 cycles", "completed rays over cycles");
  v.field("mrays_per_second_at_clock", r.mrays_per_second_at_clock, "Mrays/s", "the same at engine.clock_mhz");
}

struct Throughput {
  double packets_per_ray = 0, hops_per_ray = 0, tests_per_ray = 0;
  std::optional<Rate> whole{}, steady{};
};

template <class V>
void describe(V& v, const Throughput& r) {
  v.field("packets_per_ray", r.packets_per_ray, "packets/ray", "packets issued for each completed ray");
  v.field("hops_per_ray", r.hops_per_ray, "hops/ray", "links crossed by packets for each completed ray");
  v.field("tests_per_ray", r.tests_per_ray, "tests/ray",
          "box, plane, triangle, procedural and bundle tests for each completed ray");
  v.section("whole", r.whole, "simulated speed from the first cycle to the last");
  v.section("steady", r.steady,
            "simulated speed between fill and drain, by the frame's work; absent if the frame is too short for it");
}

}  // namespace carousel::report
