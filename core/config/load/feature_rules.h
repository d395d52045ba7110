#pragma once

#include "core/config/load/network_rules.h"

namespace carousel::config {

// The rules of features that machines may have, each in a file of its own.

/// The rules of a series of frames: what moves, and how the structure follows it.
void check_frames(const Config& config, const RuleBreach& breach);

/// The rules of `rays.query`: which workloads ask, and which machines look for several nearest hits.
void check_query(const Config& config, const RuleBreach& breach);

/// The rules of `bvh.treelets` and of `collections.grouped`, which needs them.
void check_treelets(const Config& config, const RuleBreach& breach);

/// The rules of drawings whose resources trace their own rays (`topology.trace: stacks`).
void check_stacks(const Config& config, const RuleBreach& breach);

/// The rules of rays in warps (`testers.simt`).
void check_warps(const Config& config, const RuleBreach& breach);

}  // namespace carousel::config
