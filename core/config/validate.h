#pragma once

#include <vector>

#include "core/config/config.h"
#include "core/config/tree/positions.h"
#include "core/system/error.h"

namespace carousel {

struct ValidateOptions {
  bool force = false;  ///< permits what is known to be able to deadlock (`flow: none`)
};

/// The rules that concern more than one field, and what this version has not built. Returns every breach, at
/// the position of the key that breaks the rule.
std::vector<ConfigIssue> validate_config(const Config& config, const KeyPositions& positions,
                                         const ValidateOptions& options = {});

}  // namespace carousel
