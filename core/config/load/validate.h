#pragma once

#include <vector>

#include "core/config/config.h"
#include "core/config/tree/positions.h"
#include "core/system/error.h"

namespace carousel {

struct ValidateOptions {
  bool force = false;        ///< permits `flow: none`, which can deadlock
  bool ranks = false;        ///< the caller can play `engine.transport: mpi`; asked when a run is prepared
  bool frames = false;       ///< the caller shows series of frames; asked likewise
  bool searches = false;     ///< the caller searches for the split of `area.fit: best`; asked likewise
  bool fields_only = false;  ///< `load_config` leaves the rules out, for tests of reader and writer
};

/// Checks the rules that concern more than one field, and the values that the engine does not have
/// (core/config/not_built.h). Returns every breach, at the position of the key that breaks the rule.
std::vector<ConfigIssue> validate_config(const Config& config, const KeyPositions& positions = {},
                                         const ValidateOptions& options = {});

}  // namespace carousel
