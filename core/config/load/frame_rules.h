#pragma once

#include "core/config/load/network_rules.h"

namespace carousel::config {

/// The rules of a series of frames: what moves, and how the structure follows it.
void check_frames(const Config& config, const RuleBreach& breach);

}  // namespace carousel::config
