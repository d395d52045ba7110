#pragma once

#include <vector>

#include "core/types/aabb.h"
#include "scene/model/scene.h"

namespace carousel::scene {

/// World-space bounds of each of Scene::nodes, as Scene::bounds() computes them. The time is that of all instances,
/// once.
std::vector<Aabb> node_bounds(const Scene& scene);

}  // namespace carousel::scene
