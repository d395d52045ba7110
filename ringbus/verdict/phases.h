#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "ringbus/results/run_result.h"
#include "ringbus/verdict/bottleneck_search.h"
#include "ringbus/verdict/foretell.h"
#include "ringbus/verdict/what_if.h"

namespace carousel::ringbus {

/// A stretch of a frame in which one class of parts gains most when it is relaxed.
struct FramePhase {
  double begin = 0, end = 0;  ///< completed rays, as fractions of all
  double time = 0;            ///< part of the cycles of the machine as configured
  std::size_t best = 0;       ///< index of the relaxed machine that gains most; kNoClass if none gains enough
  double gain = 0;            ///< of that machine in this stretch: cycles over cycles, less 1
};
inline constexpr std::size_t kNoClass = ~std::size_t{0};

/// Cuts a run over some rays where the class changes that limits it. `relaxed`: the same rays on machines with one
/// class relaxed each.
///
/// All runs are cut into blocks of equal numbers of completed rays. Of all sequences of classes, one for each block,
/// the one is taken that saves most time, less a price for each change. The price is three standard deviations of the
/// time that a block saves by chance, and at least 2 % of the run, so that noise makes no phases. One phase if nothing
/// changes; none without a relaxed machine.
std::vector<FramePhase> frame_phases(const PilotRun& base, const std::vector<PilotRun>& relaxed);

/// As frame_phases(), with the classes' names. `relaxed`: by index of `what_ifs`.
std::vector<GainPhase> gain_phases(const RunResult& base, const std::vector<WhatIf>& what_ifs,
                                   const std::map<std::size_t, RunResult>& relaxed);

}  // namespace carousel::ringbus
