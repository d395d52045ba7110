#pragma once

#include "core/config/fields/scene.h"
#include "scene/model/scene.h"

namespace carousel::scene {

/// Adds the objects of the configuration to a scene: a mesh for each primitive and material, an instance for each
/// object. Throws ConfigError for an object of no primitive, or one whose program is wrong.
void place_objects(Scene& scene, const SceneConfig& config, const PrimitivesConfig& primitives,
                   const ProgramsConfig& programs);

}  // namespace carousel::scene
