#pragma once

#include "core/config/load/network_rules.h"

namespace carousel::config {

/// The rules of rays in warps (`testers.simt`).
void check_warps(const Config& config, const RuleBreach& breach);

}  // namespace carousel::config
