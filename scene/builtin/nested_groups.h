#pragma once

#include <cstdint>

#include "scene/model/scene.h"

namespace carousel::scene {

/// Fills the scene with `instances` placements of its meshes 0 to `shapes` - 1 in groups `depth` deep: there are three
/// groups at every depth, each of the same number of members drawn from the three below, so that a group of few members
/// is placed many times. Instances that make up no whole group of the first depth stand alone. Returns the radius of
/// the disc that all lie on, around the vertical axis.
float place_groups(Scene& scene, std::int64_t instances, std::int64_t seed, std::int64_t depth, std::uint32_t shapes);

}  // namespace carousel::scene
