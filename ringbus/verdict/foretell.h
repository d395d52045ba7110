#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "ringbus/results/cycle_result.h"

namespace carousel::ringbus {

// A frame's cycles and gains, foretold from a pilot: some of its paths, simulated from start to end.
//
// A pilot's fill, drain and cold caches weigh more than the frame's. So its cycles T are extrapolated: the frame's
// further rays take as long each as those of the pilot between fill and drain, m:
//   frame = T + (frame's rays - pilot's rays) m.
// The rays of a machine and of a relaxed one are the same, and m is taken between the same counts of completed rays in
// both, so that the mix of rays is too. A pilot that is the whole frame needs no extrapolation.
//
// Dear rays are completed late, and a pilot's may be dearer than the frame's. Where the time of a test varies less from
// block to block than that of a ray, tests are counted instead of rays: those that were done so far, box and triangle
// tests with equal weight, in units of the pilot's tests a ray. The frame's tests are known from its run.

/// A machine's run over a pilot's rays, or over all of them.
struct PilotRun {
  const cycle::CycleResult* result = nullptr;
  std::uint64_t rays = 0;
};

/// A value with its interval of confidence, some 95 %.
struct Estimate {
  double value = 0, low = 0, high = 0;
};

/// Two estimates of the same gain in one, if their errors are independent. Times of the relaxed machine are averaged,
/// and the narrower estimate counts more.
Estimate both(const Estimate& a, const Estimate& b);

class Foretelling {
 public:
  /// `frame_rays`: rays of the whole frame. `fill`: completed rays after which every machine that is compared is full.
  /// `frame`: the frame's run on the pilot's machine; null: tests are not counted.
  Foretelling(PilotRun base, std::uint64_t frame_rays, std::uint64_t fill, const cycle::CycleResult* frame = nullptr);

  /// Tests are counted, and not rays.
  bool by_tests() const { return by_tests_; }
  /// The frame's cycles on the pilot's machine. The interval is that of the differences between neighbouring parts of
  /// the pilot; of a whole frame, whose cycles are known, none.
  Estimate cycles() const;
  /// The frame's busy cycles of each class of CycleResult::uses.
  std::vector<double> busy() const;
  /// The frame's gain if the machine is replaced by that of `relaxed`, as a fraction: cycles over cycles, less 1.
  ///
  /// The interval has two parts. The pilot is cut into blocks of equal numbers of rays. Both machines simulate the same
  /// rays, so only the difference between both times from one block's mean completion to the next one's counts, d;
  /// neighbouring blocks are of neighbouring strata, so the variance is that of their successive differences, (d[i+1] -
  /// d[i])^2 / 2, as for any systematic sample (K. Wolter, Introduction to Variance Estimation, 2nd edition 2007,
  /// section 8.2, v2). The frame with another seed of its picture differs from this one, too, by as much as its own
  /// rays make it, N in all beside the pilot's n: two standard errors, times the root of 1 + n / N, count, also of a
  /// pilot that is the whole frame. `deviation`, the fraction by which the frame is known to differ from its
  /// foretelling, is another error, as if independent: if three quarters of it lie in the class at question, the time
  /// that the class limits is off by as much.
  ///
  /// `warms`: the relaxed machine has more room for shapes, and may go on filling it after it is full of rays. If the
  /// later half of the pilot gains surely more than the earlier one, it stands for the frame's further rays, and the
  /// interval's upper end is as much farther up as these halves differ, since it may not be warm yet.
  ///
  /// Where tests are counted, rays are tried as well, and the narrower interval counts: the relaxed class may not test.
  Estimate gain(PilotRun relaxed, double deviation, bool warms = false) const;

 private:
  struct Window {
    double begin = 0, end = 0;  // rays, or tests in units of as many as a ray of the pilot has
    double size() const { return end - begin; }
  };
  /// How far a run had come at each sample, in the unit of windows.
  using Places = std::vector<double>;

  bool whole() const { return base_.rays >= frame_rays_; }
  Places places(const PilotRun& run) const;
  double place_of_count(const PilotRun& run, const Places& places, std::uint64_t completed) const;
  Window window(const PilotRun& other, const Places& places) const;
  double frame_cycles(const PilotRun& run, const Places& places, Window window) const;
  double unsteadiness() const;
  void count_tests(const cycle::CycleResult& frame);

  PilotRun base_;
  std::uint64_t frame_rays_, fill_;
  bool by_tests_ = false;
  double frame_size_;  // in the unit of windows
  Places base_places_;
  std::shared_ptr<const Foretelling> by_rays_;  // only where tests are counted
};

}  // namespace carousel::ringbus
