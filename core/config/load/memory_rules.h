#pragma once

#include "core/config/load/network_rules.h"

namespace carousel::config {

/// The rules of the simulated memory: DRAM, caches, the storage of the structure, and data of rays in it.
void check_memory(const Config& config, const RuleBreach& breach);

}  // namespace carousel::config
