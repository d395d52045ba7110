#pragma once

#include <string>

#include "app/sweep/sweep_run.h"

namespace carousel::app {

/// The key whose value tells sampled points from whole ones.
inline constexpr const char* kSampledKey = "sampling.fraction";

/// Replaces the sampled points of the Pareto front by the same points with the whole frame, and runs these; again and
/// again until the front has no sampled point. `goals` as for parse_goals(). For sweeps with the key kSampledKey.
void run_front_whole(const SweepSetup& setup, const SweepOptions& options, PointMaker& maker, const std::string& goals,
                     SweepRows& rows, Ledger* ledger, const InterruptScope& interrupt);

}  // namespace carousel::app
