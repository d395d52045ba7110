#pragma once

#include "core/config.h"
#include "core/ray.h"
#include "core/workload.h"
#include "scene/scene.h"

namespace carousel::accel {

/// The closest hit by testing every triangle of every instance, in plain scalar code that shares nothing with
/// the SIMD kernels but the definition of a hit (DESIGN.md section 3), the instance transform and the exact triangle
/// test, which is scalar anyway. Slow; for tests on small scenes.
Hit brute_force(const scene::Scene& scene, const RayRequest& request, const AccuracyConfig& accuracy = {});

}  // namespace carousel::accel
