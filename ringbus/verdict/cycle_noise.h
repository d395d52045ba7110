#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace carousel::ringbus {

/// By how much the cycles of a frame differ for another seed of its picture: other rays, and another schedule.
struct CycleNoise {
  /// Two frames with different seeds differ by less, with 95 % of confidence; a fraction of their cycles.
  double fraction = 0;
  std::size_t seeds = 0;  ///< beside that of the run
  bool whole = false;     ///< of whole frames, not of pilots
};

/// The noise from the cycles of equal machines with different seeds, in frames or in pilots of `part` of the frame's
/// paths. The difference of two draws of a normal distribution has the root of 2 times its deviation, which is
/// estimated from n draws; so the interval is that of Student's distribution with n - 1 degrees of freedom. A frame is
/// 1 / part pilots long, and their deviations are taken as independent: the fraction shrinks with the root of `part`.
/// Absent with fewer than three draws.
std::optional<CycleNoise> cycle_noise(const std::vector<double>& cycles, double part);

}  // namespace carousel::ringbus
