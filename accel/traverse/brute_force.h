#pragma once

#include <vector>

#include "core/config/config.h"
#include "core/types/any_hit.h"
#include "core/types/ray.h"
#include "core/types/workload.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// The closest hit by testing every primitive of every instance as accel/traverse/oracle_primitive.h does. Non-opaque
/// materials call `any_hit`, unless it is null. Slow; for tests on small scenes.
Hit brute_force(const scene::Scene& scene, const RayRequest& request, const AccuracyConfig& accuracy = {},
                const AnyHit* any_hit = nullptr);

/// All hits likewise, in no order.
std::vector<Hit> brute_force_all(const scene::Scene& scene, const RayRequest& request,
                                 const AccuracyConfig& accuracy = {}, const AnyHit* any_hit = nullptr);

}  // namespace carousel::accel
