#pragma once

#include <cstdint>
#include <vector>

#include "app/accuracy/pictures.h"
#include "core/types/workload.h"
#include "report/accuracy/accuracy.h"
#include "scene/model/scene.h"

namespace carousel::app {

/// A small scene and rays whose hits depend on rounding. Deterministic for a seed.
struct HardScene {
  report::HardCase about;
  scene::Scene scene;
  RayBatch rays;
};

/// The built-in hard scenes, each with `rays` rays.
std::vector<HardScene> hard_scenes(std::size_t rays, std::uint64_t seed);

/// Rays that leave balls 10^4 and 10^6 scene units away from the origin, each traced with the default levels.
SelfHits self_hits_far_away(SpawnOffset spawn, std::size_t rays, std::uint64_t seed);

}  // namespace carousel::app
