#pragma once

#include "core/config/load/network_rules.h"

namespace carousel::config {

/// The rules of what bounds geometry and rays: elements of nodes, levels of groups, cull planes and bundles.
void check_bounds(const Config& config, const RuleBreach& breach);

}  // namespace carousel::config
