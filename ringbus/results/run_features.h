#pragma once

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "core/statistics/run_features.h"

namespace carousel::ringbus {

/// The features of the configured machine with a scene: its report shows, and its what-ifs relax, only these.
inline RunFeatures features_of(const Config& config, const accel::Accel& accel) {
  return {.cull_planes = config.cull_planes.count > 0,
          .bundles = config.bundles.size > 0,
          .procedural = accel.procedural_primitives,
          .any_hit = accel.calls_any_hit(),
          .any_hit_units = accel.calls_any_hit() && config.testers.any_hit == TestersConfig::AnyHit::kInline,
          .quantised = config.bvh.storage == BvhConfig::Storage::kQuantised};
}

}  // namespace carousel::ringbus
