#pragma once

#include <string>
#include <vector>

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
  std::vector<std::string> sets;
  double rays_per_kilocycle = 0, gain = 0, low = 0, high = 0;
  std::uint64_t together = 1;
};

template <class V>
void describe(V& v, const BottleneckGain& r) {
  v.field("name", r.name, "", "class of parts");
  v.field("action", r.action, "", "change that relaxed the class");
  v.field("sets", r.sets, "", "the same change as values of --set, to be tried");
  v.field("rays_per_kilocycle", r.rays_per_kilocycle, "rays/1000 cycles",
          "rate that is foretold for the whole frame on the relaxed machine");
  v.field("gain", r.gain, "fraction", "gain over the machine as configured, for the whole frame");
  v.field("low", r.low, "fraction", "lower end of the gain's interval of confidence (95 %)");
  v.field("high", r.high, "fraction", "upper end of the gain's interval of confidence (95 %)");
  v.field("together", r.together, "classes",
          "classes that were relaxed together in the simulation: if more than 1, the gain is that of all of them");
}

struct Bottleneck {
  bool complete = true;
  std::string limits{}, verdict{}, unlike{};
  std::vector<std::string> rivals{};
  double rays_per_kilocycle = 0, noise = 0, deviation = 0;
  bool whole_frame = false;
  std::uint64_t paths = 0, rays = 0;
  std::vector<BottleneckGain> gains{};
};

template <class V>
void describe(V& v, const Bottleneck& r) {
  v.field("complete", r.complete, "", "false if the search was interrupted; nothing is then found out");
  v.field(
      "limits", r.limits, "",
      "class that gains most when relaxed; empty when none surely gains, or none gains 5 %, or nothing is found out");
  v.field("rivals", r.rivals, "", "further classes that may gain as much, as their intervals overlap");
  v.field("verdict", r.verdict, "", "the same in words");
  v.field("unlike", r.unlike, "", "difference between pilot and run for which nothing is found out; empty if none");
  v.field("rays_per_kilocycle", r.rays_per_kilocycle, "rays/1000 cycles",
          "rate of the whole frame on the machine as configured, without a resource's stop");
  v.field("noise", r.noise, "fraction",
          "half the interval of confidence of the rate that the pilot foretells for the machine as configured");
  v.field("deviation", r.deviation, "fraction", "difference of the run's cycles from those that the pilot foretells");
  v.field("whole_frame", r.whole_frame, "", "true if the pilot is the whole frame; gains are then exact");
  v.field("paths", r.paths, "paths", "paths of the pilot, drawn over the whole frame");
  v.field("rays", r.rays, "rays", "rays of the pilot, which are simulated for each class");
  v.section("gains", r.gains, "gain of each class, greatest first");
}

}  // namespace carousel::report
