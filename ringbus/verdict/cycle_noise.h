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

/// The noise from the cycles of equal machines with different seeds, in whole frames or in pilots. The difference of
/// two draws of a normal distribution has the root of 2 times its deviation, which is estimated from n draws; so the
/// interval is that of Student's distribution with n - 1 degrees of freedom. A frame is many pilots long, but its
/// deviation need not fall with the root of their number: parts that are slow in one seed are so for all of the frame.
/// So a pilot's is taken as it is, which is too wide rather than too narrow. Absent with fewer than three draws.
std::optional<CycleNoise> cycle_noise(const std::vector<double>& cycles, bool whole);

}  // namespace carousel::ringbus
