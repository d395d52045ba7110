#pragma once

#include <vector>

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "core/system/error.h"
#include "ringbus/topology/plan.h"

namespace carousel::ringbus {

/// Tells before a run whether the links of a machine can fill up and stop (docs/how-it-works/design.md, Deadlock and
/// the end).
DeadlockVerdict deadlock_verdict(const TopologyConfig& config);
/// The same for what runs on it: on a graph, synthetic traffic has dangers of its own.
DeadlockVerdict deadlock_verdict(const Config& config);

/// Ray IDs of collection storage a resource needs so that bounded storage (`when_full: reserve`) cannot block:
/// twice the reserve that deepest-first draining uses, since new rays are admitted only above half free; one
/// block for ordered traversal, which admits a ray a block. 0 with `when_full: spill`, and where nothing is collected.
std::int64_t minimum_capacity(const Config& config, int width, int max_depth);

/// The rules that need the built structure. Positions are left to the caller, who knows the file.
std::vector<ConfigIssue> check_storage(const Config& config, const accel::Accel& accel);

}  // namespace carousel::ringbus
