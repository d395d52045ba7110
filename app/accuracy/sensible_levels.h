#pragma once

#include <vector>

#include "core/config/fields/accuracy.h"
#include "scene/model/scene.h"

namespace carousel::app {

/// The combinations of levels that are worth comparing on a scene, cheapest first: each triangle test with suitable
/// boxes, each transform with the default tests, and the cheapest and the most exact of all. Transforms vary only if an
/// instance has one. All other keys, the spawn offset included, are those of `base`.
std::vector<AccuracyConfig> sensible_levels(const scene::Scene& scene, const AccuracyConfig& base);

}  // namespace carousel::app
