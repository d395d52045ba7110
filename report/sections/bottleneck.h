#pragma once

#include "report/sections/visitor.h"

namespace carousel::report {

/// The rate that a class of parts alone would allow.
struct BoundClass {
  std::string name;
  double rays_per_kilocycle = 0;
};

template <class V>
void describe(V& v, const BoundClass& r) {
  v.field("name", r.name, "", "class of parts");
  v.field("rays_per_kilocycle", r.rays_per_kilocycle, "rays/1000 cycles",
          "rate if the class were busy all the time, at this run's work for each ray");
}

struct Bound {
  double rays_per_kilocycle = 0, reached = 0;
  std::vector<BoundClass> classes;
};

template <class V>
void describe(V& v, const Bound& r) {
  v.field("rays_per_kilocycle", r.rays_per_kilocycle, "rays/1000 cycles", "least rate of all classes");
  v.field("reached", r.reached, "fraction", "rate of the whole run over that rate");
  v.section("classes", r.classes, "rate of each class, tightest first");
}

/// The outcome of relaxing one class of parts.
struct BottleneckGain {
  std::string name, action;
  double rays_per_kilocycle = 0, gain = 0;
};

template <class V>
void describe(V& v, const BottleneckGain& r) {
  v.field("name", r.name, "", "class of parts");
  v.field("action", r.action, "", "change that relaxed the class");
  v.field("rays_per_kilocycle", r.rays_per_kilocycle, "rays/1000 cycles", "steady rate of the relaxed machine");
  v.field("gain", r.gain, "fraction", "gain over the machine as configured");
}

struct Bottleneck {
  std::string limits, verdict;
  double rays_per_kilocycle = 0, noise = 0;
  std::uint64_t paths = 0;
  std::vector<BottleneckGain> gains;
};

template <class V>
void describe(V& v, const Bottleneck& r) {
  v.field("limits", r.limits, "", "class that gains most when relaxed; empty when none gains 5 %");
  v.field("verdict", r.verdict, "", "the same in words");
  v.field("rays_per_kilocycle", r.rays_per_kilocycle, "rays/1000 cycles",
          "steady rate of the machine as configured, over the same rays");
  v.field("noise", r.noise, "fraction", "difference between the rates of the two halves of that steady state");
  v.field("paths", r.paths, "paths", "paths simulated for each class");
  v.section("gains", r.gains, "gain of each class, greatest first");
}

}  // namespace carousel::report
