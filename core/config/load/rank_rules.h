#pragma once

#include "core/config/config.h"
#include "core/config/load/network_rules.h"

namespace carousel::config {

/// The rules of `engine.transport` and `scene.placement`: what a machine that several processes play cannot do yet.
void check_ranks(const Config& config, const RuleBreach& breach);

}  // namespace carousel::config
