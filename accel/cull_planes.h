#pragma once

#include "accel/accel.h"
#include "core/config.h"
#include "core/executor.h"

namespace carousel::accel {

/// Gives the children of all nodes below the instances up to config.count planes each (US 20250259373): `leaves`, `inner`
/// children or all. Once a structure, which was built without. Deterministic for any executor. Without planes (count 0)
/// nothing changes.
void add_cull_planes(Accel& accel, const CullPlanesConfig& config, Executor& executor);

}  // namespace carousel::accel
