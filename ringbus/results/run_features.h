#pragma once

#include <algorithm>

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "core/config/key_conditions.h"
#include "core/statistics/run_features.h"

namespace carousel::ringbus {

/// The things in a scene that put test units to use, once its structure is built.
inline SceneFacts scene_facts(const accel::Accel& accel) {
  const auto moved = [](const accel::InstanceNode& instance) { return !instance.transform.identity; };
  return {.transforms = std::any_of(accel.instances.begin(), accel.instances.end(), moved),
          .any_hit = accel.calls_any_hit(),
          .procedural = accel.procedural_primitives,
          .planes = !accel.planes.empty(),
          .gaussians = accel.gaussians != nullptr,
          .harmonics = accel.gaussians != nullptr && accel.gaussians->degree() > 0};
}

/// The features of the configured machine with a scene: its report shows only these.
inline RunFeatures features_of(const Config& config, const accel::Accel& accel) {
  return {.cull_planes = config.cull_planes.count > 0,
          .bundles = config.bundles.size > 0,
          .procedural = accel.procedural_primitives,
          .any_hit = accel.calls_any_hit(),
          .any_hit_units = has_units(config, scene_facts(accel), UnitKind::kAnyHit),
          .quantised = is_quantised(config.bvh.storage),
          .micromaps = has_units(config, scene_facts(accel), UnitKind::kMicromap),
          .nearest = config.rays.query.nearest > 0,
          .programs = !accel.programs.empty(),
          .blocks = config.bvh.leaves == BvhConfig::Leaves::kBlocks};
}

}  // namespace carousel::ringbus
