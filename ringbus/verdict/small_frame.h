#pragma once

#include <cstdint>
#include <optional>

#include "ringbus/results/cycle_result.h"

namespace carousel::ringbus {

/// Rounded up to two digits.
std::uint64_t two_digits_up(double value);

/// A frame that mostly fills its machine with rays and drains it.
struct SmallFrame {
  std::uint64_t paths = 0, slots = 0;  ///< paths, or rays of a list, that the frame begins; ray slots of the machine
  double between = 0;                  ///< part of its rays that were completed between fill and drain
  std::uint64_t least_paths = 0;       ///< paths that would do, about: two digits, rounded up
};

/// The part of a run's rays that were completed between fill and drain (steady_state.h says when these are); 0 if the
/// run does not say when its last path began.
double part_between(const cycle::CycleResult& result, std::uint64_t rays, std::uint64_t slots);

/// A frame is too small if less than three quarters of its rays are completed between fill and drain. Slots are then
/// empty for much of the time, and another part may limit the machine than in a larger frame. It does not see caches
/// that are cold. `paths`: that the frame begins. Absent if the frame is large enough, or if the run does not say when
/// its last path began.
std::optional<SmallFrame> small_frame(const cycle::CycleResult& result, std::uint64_t rays, std::uint64_t paths,
                                      std::uint64_t slots);

}  // namespace carousel::ringbus
