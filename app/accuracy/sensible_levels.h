#pragma once

#include <vector>

#include "core/config/config.h"
#include "scene/model/scene.h"

namespace carousel::app {

/// The combinations of levels worth comparing on a scene, cheapest first: each triangle test with the boxes that suit
/// it, the transforms in turn with the default tests, and both ends of everything at once. Transforms only if an
/// instance has one. Spawn offset and the rest are `base`'s.
std::vector<AccuracyConfig> sensible_levels(const scene::Scene& scene, const AccuracyConfig& base);

}  // namespace carousel::app
