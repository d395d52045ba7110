#pragma once

#include "core/config/load/network_rules.h"

namespace carousel::config {

/// The rules of `rays.query`: which workloads ask, and which machines look for several nearest hits.
void check_query(const Config& config, const RuleBreach& breach);

}  // namespace carousel::config
