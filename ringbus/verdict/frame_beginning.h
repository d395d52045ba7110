#pragma once

#include <cstdint>

#include "ringbus/results/cycle_result.h"
#include "ringbus/verdict/foretell.h"

namespace carousel::ringbus {

// The gain of a relaxed machine, foretold from the beginning of the frame.
//
// The run says when it had completed how many rays. So a relaxed machine that simulates the same frame from its start,
// and stops after some of the rays, needs no simulation of the machine as configured beside it. Fill, cold caches and
// the order of the rays are those of the run, and what it saved until then is known. Only the rest is foretold.

/// The rays that a run had completed after a part of its cycles.
struct FrameBeginning {
  double part = 0;  ///< of the cycles, 0 to 1
  std::uint64_t rays = 0;
};

/// `part`: of the run's cycles, above 0, at most 1.
FrameBeginning beginning_of(const cycle::CycleResult& run, double part);

/// The part of the cycles after which the run had completed so many rays.
double part_of(const cycle::CycleResult& run, double rays);

/// The part of the rest of the frame, 0 to 1, that no block of the beginning is like (below): what a relaxed machine
/// takes there is not known. `fill`: as below.
double unknown_rest(const cycle::CycleResult& run, const FrameBeginning& beginning, std::uint64_t fill);

/// A frame may begin with sky, which limits a machine in another way than the rest. True if no more than a quarter of
/// the frame is unknown after this part of its cycles.
bool tells_of_rest(const cycle::CycleResult& run, double part, std::uint64_t fill);

/// The part of the frame that takes no more than `taken` of the run's cycles, and of its rays.
double part_that_takes(const cycle::CycleResult& run, std::uint64_t rays, double taken);

/// The gain of the machine of `relaxed` for the whole frame: the run's cycles over its own, less 1. `relaxed` has
/// completed the rays of the beginning, and need not have gone on.
///
/// The beginning is cut into blocks of equal time of the run. In each the relaxed machine takes so many of its cycles
/// for one of the run's. A block of the rest takes the mean of those of the beginning, with more weight for those in
/// which the run kept its classes of parts about as busy; and where there is none, halfway between that and no gain.
/// The interval has four parts: the differences of neighbouring blocks of the beginning; what these leave of the
/// deviation of its blocks, which is a trend; the part of the rest that no block of the beginning is like; and that of
/// the frame with another seed of its picture (foretell.h).
///
/// `fill`: completed rays after which both machines are full. Blocks before that say nothing of the rest; at least an
/// eighth of them is left out, and half at most. `warms`: the relaxed machine has more room for shapes, and may go on
/// filling it. If it saves more in the later half of the beginning than in the earlier one, it may save as much more
/// again in the rest.
Estimate gain_by_beginning(const cycle::CycleResult& run, const cycle::CycleResult& relaxed,
                           const FrameBeginning& beginning, std::uint64_t fill, bool warms = false);

}  // namespace carousel::ringbus
