#pragma once

#include <cstdint>
#include <optional>

#include "ringbus/results/cycle_result.h"

namespace carousel::ringbus {

/// Completed rays after which a machine is full, by its ray slots: the first rays have left them, and long ones have
/// gathered among those that came after.
constexpr std::uint64_t fill_rays(std::uint64_t slots) {
  return 2 * slots;
}

/// The part of a run between fill and drain.
struct SteadyState {
  Cycle cycles = 0;
  double share = 0;  ///< part of the frame's work that was done in these cycles
};

/// The steady state begins when fill_rays() have been completed, and ends when the last ray that no other ray causes
/// has begun. The rays in between may be cheaper than those of the whole frame. Their share of the work is therefore
/// taken of the class of parts that did least of its work in that time, among those that are at least half as busy as
/// the busiest; the rate of `share` times all rays over `cycles` is then never above the bound of such a class. Absent
/// if less than half of the rays fall into the window, or if its mix is not the frame's, so that no rate would mean
/// much.
std::optional<SteadyState> steady_state(const cycle::CycleResult& result, std::uint64_t rays, std::uint64_t slots);

}  // namespace carousel::ringbus
