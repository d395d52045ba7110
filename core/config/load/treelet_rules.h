#pragma once

#include "core/config/load/network_rules.h"

namespace carousel::config {

/// The rules of `bvh.treelets` and of `collections.grouped`, which needs them.
void check_treelets(const Config& config, const RuleBreach& breach);

}  // namespace carousel::config
