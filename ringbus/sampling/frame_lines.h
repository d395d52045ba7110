#pragma once

#include "ringbus/sampling/sample_estimate.h"

namespace carousel::ringbus {

/// The lines that a whole frame asks for at least once, of `lines` that there are, if a sample asked for `in_half` of
/// them in the first half of its rays and for `in_sample` in all, and the frame has `times` as many rays.
///
/// Lines are asked for by chance, some far more often than others: a line is asked for at a rate of its own, and rates
/// have a gamma distribution. A sample of n rays then leaves the part (1 + a n)^-k of the lines out (the negative
/// binomial; R. A. Fisher, A. S. Corbet, C. B. Williams, J. Animal Ecology 12, 1943). The two counts give a and k. The
/// upper end is that of equal rates, which leave out the fewest. The lower end is nearer to the sample's count by
/// kUnsureTouches of the difference.
Estimate first_touches(double in_half, double in_sample, double lines, double times);

/// The requests to memory of a sample, and what they tell about those of the frame; see estimate_frame().
class FrameLines {
 public:
  /// Completed rays between fill and drain.
  struct Window {
    std::uint64_t begin = 0, end = 0;
  };
  /// The frame has `times` as many rays as the sample.
  FrameLines(const Config& config, const SampleRun& run, Window window, double times);

  /// Requests of the sample: those of a cache for a line of shapes that it had not asked for, and all requests.
  double first() const { return first_; }
  double sample() const { return first_ + again_ + other_; }
  /// Requests of the frame, likewise. `error` is the relative error of requests a ray.
  Estimate frame_first() const { return frame_first_; }
  Estimate frame(double error) const;

 private:
  double times_, rays_, cached_;  // cached_: lines that the caches hold
  double first_ = 0, again_ = 0, other_ = 0;
  double late_first_ = 0, late_again_ = 0, late_rays_ = 0;  // in the later half of the window
  Estimate frame_first_;
};

}  // namespace carousel::ringbus
