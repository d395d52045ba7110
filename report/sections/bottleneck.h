#pragma once

#include <cstdint>
#include <optional>
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
  double frame = 0;
};

template <class V>
void describe(V& v, const BottleneckGain& r) {
  v.field("name", r.name, "", "class of parts");
  v.field("action", r.action, "", "change that relaxed the class");
  v.field("sets", r.sets, "", "the same change as values of --set, to be tried");
  v.field("rays_per_kilocycle", r.rays_per_kilocycle, "rays/1000 cycles",
          "rate that is foretold for the whole frame on the relaxed machine");
  v.field("gain", r.gain, "fraction", "gain over the machine as configured, for the whole frame");
  v.field("low", r.low, "fraction",
          "lower end of the gain's interval of confidence (95 %), which covers other seeds of the picture");
  v.field("high", r.high, "fraction", "upper end of the gain's interval of confidence (95 %)");
  v.field("together", r.together, "classes",
          "classes that were relaxed together in the simulation: if more than 1, the gain is that of all of them; 0: "
          "none was simulated, as the run's ledger bounds the gain below 5 %");
  v.field(
      "frame", r.frame, "fraction",
      "part of the run's cycles, from its start, for which the relaxed machine was simulated; 0: for the pilot alone");
}

/// A class of parts that no configuration may relax so.
struct UntriedClass {
  std::string name, action, why;
};

template <class V>
void describe(V& v, const UntriedClass& r) {
  v.field("name", r.name, "", "class of parts");
  v.field("action", r.action, "", "change that would relax the class");
  v.field("why", r.why, "", "what `carousel check` says of such a configuration, or that other classes took the rays");
}

/// A frame that is too small beside the ray slots of its machine for a verdict.
struct FrameTooSmall {
  std::uint64_t paths = 0, slots = 0;
  double between = 0;
  bool search = false;
  std::uint64_t least_paths = 0;
  std::string busiest{};
  double busy = 0;
};

template <class V>
void describe(V& v, const FrameTooSmall& r) {
  v.field("paths", r.paths, "paths", "paths, or rays of a list, that the frame begins");
  v.field("slots", r.slots, "slots", "ray slots of the machine");
  v.field("between", r.between, "fraction",
          "part of the rays that were completed between fill and drain; three quarters would do");
  v.field("search", r.search, "", "the frame fills the machine, but the least search would take longer than it may");
  v.field("least_paths", r.least_paths, "paths", "paths that would do on this machine, about, also for a search");
  v.field("busiest", r.busiest, "", "class of parts that was busy for most of the run");
  v.field("busy", r.busy, "fraction", "part of the time in which its parts were busy, in the mean");
}

/// Reads of memory of which so many are the first of their lines that `limits` may gain only while caches are cold.
struct ColdCaches {
  std::uint64_t reads = 0, first = 0;
  std::string when_warm{};
};

template <class V>
void describe(V& v, const ColdCaches& r) {
  v.field("reads", r.reads, "lines", "lines read from memory between fill and drain");
  v.field("first", r.first, "lines", "those that had not been read before: a larger frame has hardly more of them");
  v.field("when_warm", r.when_warm, "",
          "class that may gain most in a larger frame, which reads hardly more lines for the first time: `limits`, or "
          "one that is not of the way to memory; empty if none is known");
}

/// A stretch of the pilot in which one class of parts gains most.
struct BottleneckPhase {
  double begin = 0, end = 0, time = 0;
  std::string limits, action;
  double gain = 0;
};

template <class V>
void describe(V& v, const BottleneckPhase& r) {
  v.field("begin", r.begin, "fraction", "completed rays of the pilot where it begins");
  v.field("end", r.end, "fraction", "completed rays of the pilot where it ends");
  v.field("time", r.time, "fraction", "part of the pilot's cycles");
  v.field("limits", r.limits, "", "class of parts that gains most in it; empty if none gains 5 %");
  v.field("action", r.action, "", "change that relaxed the class");
  v.field("gain", r.gain, "fraction", "gain over the machine as configured in these cycles");
}

struct Bottleneck {
  bool complete = true;
  std::string limits{}, verdict{}, unlike{};
  std::vector<std::string> rivals{};
  std::string group{};
  double rays_per_kilocycle = 0, noise = 0, deviation = 0;
  bool whole_frame = false;
  std::uint64_t paths = 0, rays = 0;
  std::optional<FrameTooSmall> frame_too_small{};
  std::optional<ColdCaches> cold_caches{};
  std::vector<BottleneckGain> gains{};
  std::vector<UntriedClass> untried{};
  std::vector<BottleneckPhase> phases{};
};

template <class V>
void describe(V& v, const Bottleneck& r) {
  v.field("complete", r.complete, "", "false if the search was interrupted; nothing is then found out");
  v.field("limits", r.limits, "",
          "class that gains most in this frame when relaxed, only probably if its interval reaches below 0; empty when "
          "none is likely to gain, or none gains 5 %, or nothing is found out");
  v.field("rivals", r.rivals, "", "further classes that may gain as much, as their intervals overlap");
  v.field("group", r.group, "", "what these classes and `limits` have in common; empty if nothing, or none is a rival");
  v.field("verdict", r.verdict, "", "the same in words");
  v.field("unlike", r.unlike, "", "difference between pilot and run for which nothing is found out; empty if none");
  v.field("rays_per_kilocycle", r.rays_per_kilocycle, "rays/1000 cycles",
          "rate of the whole frame on the machine as configured, without a resource's stop");
  v.field("noise", r.noise, "fraction",
          "half the interval of confidence of the rate that the pilot foretells for the machine as configured");
  v.field("deviation", r.deviation, "fraction", "difference of the run's cycles from those that the pilot foretells");
  v.field("whole_frame", r.whole_frame, "", "true if the pilot is the whole frame");
  v.field("paths", r.paths, "paths", "paths of the pilot, drawn over the whole frame");
  v.field("rays", r.rays, "rays", "rays of the pilot, which are simulated for each class");
  v.section("frame_too_small", r.frame_too_small,
            "the frame mostly fills and drains the machine, so that nothing is found out; absent otherwise");
  v.section(
      "cold_caches", r.cold_caches,
      "the memory gains most, and a quarter or more of its reads fetch what nobody had asked for, so that it gains "
      "less in a larger frame; absent otherwise");
  v.section("gains", r.gains, "gain of each class, greatest first");
  v.section(
      "untried", r.untried,
      "classes of which no gain is told: no configuration may relax them so, or the search had no rays left for them");
  v.section(
      "phases", r.phases,
      "stretches in which different classes limit the machine, in the order of time; one if it is always the same");
}

/// The interval of a run's own cycles.
struct CycleNoise {
  double fraction = 0;
  std::uint64_t low = 0, high = 0;
  std::uint64_t seeds = 0, paths = 0;
  bool whole_frame = false;
};

template <class V>
void describe(V& v, const CycleNoise& r) {
  v.field("fraction", r.fraction, "fraction",
          "half of the interval; runs of one machine with two seeds of the picture differ by less (95 %)");
  v.field("low", r.low, "cycles", "lower end of the interval around this run's cycles");
  v.field("high", r.high, "cycles", "upper end of the interval");
  v.field("seeds", r.seeds, "seeds", "other seeds of the picture that were simulated");
  v.field("paths", r.paths, "paths", "paths of each of these simulations");
  v.field("whole_frame", r.whole_frame, "",
          "true if they were whole frames; else pilots, whose noise is taken for that of the frame, which may be less");
}

}  // namespace carousel::report
