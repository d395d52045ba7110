#pragma once

#include "accel/structure/accel.h"
#include "core/config/fields/cull_planes.h"
#include "core/system/executor.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// Gives children of nodes up to config.count planes each (US 20250259373): below the instances, above them or both; to
/// leaves (above: instances), inner children or all. Call it once for a structure that was built of `scene` without
/// planes. Deterministic for any executor. Without planes (count 0) nothing changes.
void add_cull_planes(Accel& accel, const scene::Scene& scene, const CullPlanesConfig& config, Executor& executor);

/// A copy of the structure with boxes alone. Rays are traced through it to find the hits that planes and bounding
/// spheres would have lost.
Accel plain_copy(const Accel& accel);
/// True if add_cull_planes() would return the structure unchanged.
bool is_plain(const Accel& accel);

}  // namespace carousel::accel
